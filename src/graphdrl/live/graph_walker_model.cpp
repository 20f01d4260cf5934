#include "graphdrl/live/graph_walker_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>

#include "graphdrl/base/error.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

using nlohmann::json;
using Kind = StopCondition::Kind;

// "NAME(ARGUMENT)" or "NAME", with whatever stands behind it.
struct Call {
  std::string_view name;
  std::string_view argument;
};

class GeneratorText {
 public:
  explicit GeneratorText(std::string_view text) : text_(text), rest_(trimmed(text, " \t\r\n")) {}

  WalkGenerator parse() {
    const Call call = take_call();
    WalkGenerator generator{.name = std::string(call.name), .stop = {}};
    constexpr std::array kRandom = {"random", "quick_random", "quickrandom", "weighted_random"};
    if (std::ranges::find(kRandom, call.name) == kRandom.end()) {
      fail("a generator that is not run", "random, quick_random or weighted_random", call.name);
    }
    if (!rest_.empty()) fail("more than one generator", "one", rest_);
    rest_ = trimmed(call.argument, " \t\r\n");
    generator.stop.any_of.emplace_back();
    while (true) {
      generator.stop.any_of.back().push_back(parse_term(take_call()));
      if (rest_.empty()) return generator;
      if (take_word("||") || take_word("or ") || take_word("OR ")) {
        generator.stop.any_of.emplace_back();
      } else if (!take_word("&&") && !take_word("and ") && !take_word("AND ")) {
        fail("a bad stop condition", "and, or, &&, ||", rest_);
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected, std::string_view got) const {
    throw Error({.what = what, .expected = expected, .got = in_quotes(got), .where = escaped(text_)});
  }

  bool take_word(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_ = trimmed(rest_.substr(word.size()), " \t\r\n");
    return true;
  }

  Call take_call() {
    const std::size_t name = rest_.find_first_of("( \t\r\n)&|");
    Call call{.name = rest_.substr(0, name), .argument = {}};
    if (call.name.empty()) fail("a bad generator", "as random(edge_coverage(100))", rest_);
    rest_ = name == std::string_view::npos ? "" : trimmed(rest_.substr(name), " \t\r\n");
    if (!rest_.starts_with('(')) return call;
    int depth = 0;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      depth += rest_[i] == '(' ? 1 : rest_[i] == ')' ? -1 : 0;
      if (depth > 0) continue;
      call.argument = rest_.substr(1, i - 1);
      rest_ = trimmed(rest_.substr(i + 1), " \t\r\n");
      return call;
    }
    fail("a bad generator", "a closing bracket", rest_);
  }

  StopCondition::Term parse_term(const Call& call) const {
    struct Named {
      std::string_view name;
      Kind kind;
      double most;  // 0: a name
    };
    constexpr std::array<Named, 7> kTerms = {{{"edge_coverage", Kind::kEdgeCoverage, 100},
                                              {"vertex_coverage", Kind::kVertexCoverage, 100},
                                              {"length", Kind::kLength, 1e9},
                                              {"time_duration", Kind::kTimeDuration, 1e9},
                                              {"reached_vertex", Kind::kReachedVertex, 0},
                                              {"reached_edge", Kind::kReachedEdge, 0},
                                              {"never", Kind::kNever, -1}}};
    const auto found = std::ranges::find(kTerms, call.name, &Named::name);
    if (found == kTerms.end()) {
      fail("a stop condition that is not run",
           "edge_coverage, vertex_coverage, length, time_duration, reached_vertex, reached_edge or never", call.name);
    }
    StopCondition::Term term{.kind = found->kind};
    const std::string_view argument = trimmed(call.argument);
    if (found->most == 0) {
      if (argument.empty()) fail("a stop condition without a name", "as reached_vertex(NAME)", call.name);
      term.name = argument;
    } else if (found->most > 0) {
      const auto [end, error] = std::from_chars(argument.data(), argument.data() + argument.size(), term.value);
      const bool good = error == std::errc() && end == argument.data() + argument.size() && term.value >= 0;
      if (!good || term.value > found->most) {
        fail(fmt::format("a bad value of {}", call.name), fmt::format("a number from 0 to {}", found->most), argument);
      }
    }
    return term;
  }

  std::string_view text_;
  std::string_view rest_;
};

class ModelReader {
 public:
  ModelReader(const json& model, std::string place) : model_(model), place_(std::move(place)) {}

  WalkerModel read(std::string_view generator) {
    if (!model_.is_object()) fail("no model", "an object", model_);
    made_.name = text_in(model_, "name");
    if (made_.name.empty()) made_.name = text_in(model_, "id");
    made_.generator = parse_walk_generator(generator.empty() ? text_in(model_, "generator") : std::string(generator));
    refuse(model_, "model", made_.name, {"actions"});
    for (const json& vertex : list_in("vertices")) read_vertex(vertex);
    if (made_.vertices.empty()) fail("no vertices", "some", model_);
    for (const json& edge : list_in("edges")) read_edge(edge);
    find_start();
    for (const auto& terms : made_.generator.stop.any_of) {
      for (const StopCondition::Term& term : terms) check_name(term);
    }
    return std::move(made_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected, const json& got) const {
    throw Error({.what = what, .expected = expected, .got = shortened(got), .where = place_});
  }

  static std::string text_in(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  }

  const json& list_in(const char* key) const {
    const auto found = model_.find(key);
    if (found == model_.end() || !found->is_array()) fail(fmt::format("no list \"{}\"", key), "a model", model_);
    return *found;
  }

  // What only GraphWalker's interpreter runs.
  void refuse(const json& element, const char* kind, const std::string& name,
              std::initializer_list<const char*> keys) const {
    for (const char* const key : keys) {
      const auto found = element.find(key);
      if (found == element.end() || found->empty()) continue;
      if (found->is_string() && found->get_ref<const std::string&>().empty()) continue;
      throw Error({.what = fmt::format("{} \"{}\" has {}, which are not run", kind, escaped(name), key),
                   .expected = "a model without guards, actions and shared states",
                   .where = place_});
    }
  }

  static WalkerModel::Element element_of(const json& element) {
    const auto properties = element.find("properties");
    const bool has = properties != element.end() && properties->is_object();
    return {.id = text_in(element, "id"),
            .name = text_in(element, "name"),
            .properties = has ? properties->dump() : std::string("{}")};
  }

  void read_vertex(const json& vertex) {
    if (!vertex.is_object() || text_in(vertex, "id").empty()) fail("a vertex without an id", "a text", vertex);
    made_.vertices.push_back(element_of(vertex));
    const WalkerModel::Element& made = made_.vertices.back();
    refuse(vertex, "vertex", made.name.empty() ? made.id : made.name, {"sharedState", "actions"});
    const auto number = static_cast<NodeId>(made_.vertices.size() - 1);
    if (!vertex_.emplace(made.id, number).second) fail("two vertices have the same id", "different ones", vertex);
  }

  void read_edge(const json& edge) {
    if (!edge.is_object() || text_in(edge, "id").empty()) fail("an edge without an id", "a text", edge);
    made_.edges.push_back(element_of(edge));
    const WalkerModel::Element& made = made_.edges.back();
    refuse(edge, "edge", made.name.empty() ? made.id : made.name, {"guard", "actions"});
    const auto end = [&](const char* key) -> std::optional<NodeId> {
      const std::string id = text_in(edge, key);
      if (id.empty()) return kNoNode;
      const auto found = vertex_.find(id);
      return found == vertex_.end() ? std::nullopt : std::optional(found->second);
    };
    const auto from = end("sourceVertexId");
    const auto to = end("targetVertexId");
    if (!from || !to || *to == kNoNode) fail("an edge with an end that is no vertex", "ids of vertices", edge);
    made_.ends.push_back({*from, *to});
  }

  void find_start() {
    const std::string first = text_in(model_, "startElementId");
    std::vector<int> entries;
    for (int edge = 0; edge < static_cast<int>(made_.edges.size()); ++edge) {
      if (made_.edges[edge].id == first) made_.start_edge = edge;
      if (made_.ends[edge].a == kNoNode) entries.push_back(edge);
    }
    const auto vertex = vertex_.find(first);
    if (vertex != vertex_.end()) made_.start_vertex = vertex->second;
    if (first.empty() && entries.size() == 1) made_.start_edge = entries.front();
    if (made_.start_edge < 0 && made_.start_vertex == kNoNode) {
      fail(first.empty() ? "no startElementId" : "a startElementId that is no element", "an edge or a vertex",
           json(first));
    }
  }

  void check_name(const StopCondition::Term& term) const {
    const auto named = [&](const std::vector<WalkerModel::Element>& elements) {
      return std::ranges::any_of(elements, [&](const auto& one) { return one.name == term.name; });
    };
    if (term.kind == Kind::kReachedVertex && !named(made_.vertices)) fail("no such vertex", "a name", json(term.name));
    if (term.kind == Kind::kReachedEdge && !named(made_.edges)) fail("no such edge", "a name", json(term.name));
  }

  const json& model_;
  std::string place_;
  WalkerModel made_;
  std::unordered_map<std::string, NodeId> vertex_;  // by id
};

}  // namespace

WalkGenerator parse_walk_generator(std::string_view text) {
  return GeneratorText(text).parse();
}

std::vector<WalkerModel> parse_walker_models(std::string_view text, const std::string& source,
                                             std::string_view generator) {
  const json document = parse_json(text, source, "models of GraphWalker");
  const auto models = document.is_object() ? document.find("models") : document.end();
  if (!document.is_object() || models == document.end() || !models->is_array() || models->empty()) {
    throw Error({.what = "no list \"models\"", .expected = "models of GraphWalker", .where = source});
  }
  std::vector<WalkerModel> made;
  for (std::size_t i = 0; i < models->size(); ++i) {
    made.push_back(ModelReader((*models)[i], fmt::format("{}: models[{}]", source, i)).read(generator));
  }
  return made;
}

}  // namespace graphdrl
