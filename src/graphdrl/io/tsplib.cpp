#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

// Of the header. TSPSOL, the length of a tour, stands in files of OPLib.
constexpr std::string_view kKeywords[] = {"NAME",
                                          "TYPE",
                                          "COMMENT",
                                          "DIMENSION",
                                          "COST_LIMIT",
                                          "EDGE_WEIGHT_TYPE",
                                          "EDGE_WEIGHT_FORMAT",
                                          "NODE_COORD_TYPE",
                                          "TSPSOL",
                                          "DISPLAY_DATA_TYPE"};
constexpr NodeId kMostNodes = 100'000;
constexpr NodeId kMostExplicit = 20'000;  // a matrix of 3 GB
constexpr double kMostNumber = 1e15;      // of places, costs and scores: distances stay whole, and sums finite
constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kKeywordEnds = " \t\r\n:";

bool is_keyword(std::string_view word) {
  return std::ranges::find(kKeywords, word) != std::end(kKeywords);
}

enum class Distance { kEuclidean, kCeiling, kGeographic, kPseudoEuclidean };
constexpr std::string_view kDistances[] = {"EUC_2D", "CEIL_2D", "GEO", "ATT"};  // in the order of Distance

// TSPLIB's formulas (Reinelt 1995, section 2); of geographic ones with its values of pi and of the earth's radius, in
// km, and degrees cut to whole ones before minutes are read, as all solvers do.
class PlaneCosts final : public PairCosts {
 public:
  PlaneCosts(Distance distance, std::vector<Point> points) : distance_(distance), points_(std::move(points)) {
    if (distance_ != Distance::kGeographic) return;
    constexpr double kPi = 3.141592;
    const auto radians = [](double value) {
      const double degrees = std::trunc(value);
      return kPi * (degrees + 5.0 * (value - degrees) / 3.0) / 180.0;
    };
    for (Point& point : points_) point = {radians(point.x), radians(point.y)};
  }

  double cost(NodeId from, NodeId to) const override {
    const Point& a = points_[from];
    const Point& b = points_[to];
    const double dx = a.x - b.x;
    const double dy = a.y - b.y;
    switch (distance_) {
      case Distance::kEuclidean:
        return std::floor(std::sqrt(dx * dx + dy * dy) + 0.5);
      case Distance::kCeiling:
        return std::ceil(std::sqrt(dx * dx + dy * dy));
      case Distance::kPseudoEuclidean:
        return std::ceil(std::sqrt((dx * dx + dy * dy) / 10.0));
      case Distance::kGeographic:
        break;
    }
    constexpr double kRadius = 6378.388;
    if (from == to) return 0;
    const double q1 = std::cos(dy);
    const double q2 = std::cos(dx);
    const double q3 = std::cos(a.x + b.x);
    return std::floor(kRadius * std::acos(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3)) + 1.0);
  }

  bool metric() const override { return distance_ != Distance::kEuclidean; }

 private:
  Distance distance_;
  std::vector<Point> points_;
};

class MatrixCosts final : public PairCosts {
 public:
  MatrixCosts(NodeId nodes, std::vector<double> costs) : nodes_(nodes), costs_(std::move(costs)) {}
  double cost(NodeId from, NodeId to) const override {
    return costs_[static_cast<std::size_t>(from) * static_cast<std::size_t>(nodes_) + static_cast<std::size_t>(to)];
  }

 private:
  NodeId nodes_;
  std::vector<double> costs_;  // [N, N]
};

class TsplibReader {
 public:
  TsplibReader(std::string_view text, const std::string& source, const MapOptions& options)
      : text_(text), source_(source), options_(options) {}

  GraphMap read() {
    while (skip_space() && read_entry()) {
    }
    if (nodes_ == 0) fail("DIMENSION is missing");
    for (const Section& section : sections_) {
      at_ = section.begin;
      read_section(section.name);
      skip_space();
      if (at_ < section.end) fail_here("an unknown keyword", in_quotes(word(kKeywordEnds)));
    }
    return build();
  }

 private:
  // Of the file as a whole.
  [[noreturn]] void fail(const std::string& what, const std::string& got = {}) const {
    throw Error({.what = what, .got = got, .where = source_});
  }
  // Of the line read last.
  [[noreturn]] void fail_here(const std::string& what, const std::string& got = {}) const {
    throw Error({.what = what, .got = got, .where = place_in(text_, at_, source_)});
  }

  bool skip_space() {
    at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
    return at_ < text_.size();
  }
  std::string_view word(std::string_view ends = kSpace) {
    skip_space();
    const std::size_t end = std::min(text_.find_first_of(ends, at_), text_.size());
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end;
    return found;
  }
  std::size_t line_end() const { return std::min(text_.find('\n', at_), text_.size()); }
  // What stands after a keyword and its colon, to the end of the line.
  std::string_view value_of_line() {
    const std::size_t end = line_end();
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end;
    line.remove_prefix(std::min(line.find_first_not_of(" \t:"), line.size()));
    return line.substr(0, line.find_last_not_of(kSpace) + 1);
  }
  double to_number(std::string_view found, std::string_view where) const {
    if (found.empty()) fail_here(fmt::format("the file ends within {}", where));
    const std::optional<double> value = parse_number(found);
    if (!value) fail_here(fmt::format("not a number in {}", where), in_quotes(found));
    return *value;
  }
  double number(std::string_view where) {
    const std::string_view found = word();
    const double value = to_number(found, where);
    if (std::abs(value) > kMostNumber) fail_here(fmt::format("too large a number in {}", where), in_quotes(found));
    return value;
  }
  // Of a section that lists every node once.
  NodeId next_node(std::string_view where, std::vector<bool>& listed) {
    const double value = number(where);
    if (value != std::floor(value) || value < 1 || value > nodes_) {
      fail_here(fmt::format("no such node in {}: nodes are 1 to {}", where, nodes_), fmt::format("'{:g}'", value));
    }
    const NodeId found = static_cast<NodeId>(value) - 1;
    if (listed[found]) fail_here(fmt::format("node {} comes twice in {}", found + 1, where));
    listed[found] = true;
    return found;
  }

  // A line of the header or a section; false at the end.
  bool read_entry() {
    const std::string keyword(word(kKeywordEnds));
    if (keyword == "EOF") return false;
    if (keyword.ends_with("_SECTION")) {
      value_of_line();
      if (!header_.try_emplace(keyword).second) fail_here(fmt::format("{} comes twice", keyword));
      skip_section(keyword);
      return true;
    }
    if (!is_keyword(keyword)) fail_here("an unknown keyword", in_quotes(keyword));
    std::string_view value = value_of_line();
    // Some files go on with a comment, as `TYPE : TSP (M.~Hofmeister)`.
    if (keyword == "TYPE" || keyword.starts_with("EDGE_WEIGHT_")) value = value.substr(0, value.find_first_of(kSpace));
    if (!header_.try_emplace(keyword, value).second && keyword != "COMMENT")
      fail_here(fmt::format("{} comes twice", keyword));
    if (keyword == "DIMENSION") {
      to_number(value, keyword);
      const auto most = std::min<std::int64_t>(kMostNodes, std::ssize(text_));
      const auto count = parse_whole(value, 1, static_cast<double>(most));
      if (!count) {
        fail_here(fmt::format("bad DIMENSION: a number of nodes from 1 to {}, for a file of this size", most),
                  in_quotes(value));
      }
      nodes_ = static_cast<NodeId>(*count);
    } else if (keyword == "COST_LIMIT") {
      task_.budget = to_number(value, keyword);
      if (*task_.budget < 0) fail_here("a negative COST_LIMIT", in_quotes(value));
    }
    return true;
  }

  // Goes to the next keyword. Sections are read when all of the header is known, in whatever order they stand.
  void skip_section(const std::string& name) {
    const std::size_t begin = at_;
    while (skip_space()) {
      const std::size_t line_begin = at_;
      const std::string_view first = word(kKeywordEnds);
      at_ = line_begin;
      if (first == "EOF" || first.ends_with("_SECTION") || is_keyword(first)) break;
      at_ = line_end();
    }
    sections_.push_back({name, begin, at_});
  }

  void read_section(const std::string& name) {
    const auto count = static_cast<std::size_t>(nodes_);
    std::vector<bool> listed(count);
    if (name == "NODE_COORD_SECTION" || name == "DISPLAY_DATA_SECTION") {
      std::vector<Point> points(count);
      for (NodeId i = 0; i < nodes_; ++i) {
        Point& point = points[next_node(name, listed)];
        point.x = number(name);
        point.y = number(name);
      }
      if (places_.empty() || name == "NODE_COORD_SECTION") places_ = points;
      if (name == "NODE_COORD_SECTION") points_ = std::move(points);
    } else if (name == "NODE_SCORE_SECTION") {
      prizes_.resize(count);
      for (NodeId i = 0; i < nodes_; ++i) {
        double& prize = prizes_[next_node(name, listed)];
        prize = number(name);
        if (prize < 0) fail_here("a negative score in NODE_SCORE_SECTION", fmt::format("'{:g}'", prize));
      }
    } else if (name == "DEPOT_SECTION") {
      for (std::string_view found = word(); found != "-1"; found = word()) {
        to_number(found, name);
        if (task_.start != kNoNode) fail_here("more than one depot");
        const auto depot = parse_whole(found, 1, nodes_);
        if (!depot) fail_here("no such depot", in_quotes(found));
        task_.start = task_.end = static_cast<NodeId>(*depot) - 1;
      }
    } else if (name == "EDGE_WEIGHT_SECTION") {
      read_matrix();
    } else {
      fail_here("an unknown section", in_quotes(name));
    }
  }

  void read_matrix() {
    const auto count = static_cast<std::size_t>(nodes_);
    if (nodes_ > kMostExplicit) fail_here(fmt::format("more than {} nodes in EDGE_WEIGHT_SECTION", kMostExplicit));
    const std::string& format = header_["EDGE_WEIGHT_FORMAT"];
    const bool full = format == "FULL_MATRIX";
    const bool upper = format.starts_with("UPPER_");
    const bool diagonal = format.ends_with("_DIAG_ROW");
    if (!full && (!(upper || format.starts_with("LOWER_")) || !format.ends_with("_ROW"))) {
      fail_here("bad EDGE_WEIGHT_FORMAT: FULL_MATRIX, or rows of one half", in_quotes(format));
    }
    // Each number takes a digit and a space.
    const std::size_t numbers = full ? count * count : count * (diagonal ? count + 1 : count - 1) / 2;
    if (text_.size() - at_ + 1 < 2 * numbers) fail_here("the file ends within EDGE_WEIGHT_SECTION");
    matrix_.assign(count * count, 0);
    for (std::size_t row = 0; row < count; ++row) {
      const std::size_t begin = full || !upper ? 0 : row + (diagonal ? 0 : 1);
      const std::size_t end = full || upper ? count : row + (diagonal ? 1 : 0);
      for (std::size_t col = begin; col < end; ++col) {
        const double cost = number("EDGE_WEIGHT_SECTION");
        if (cost < 0) fail_here("a negative cost in EDGE_WEIGHT_SECTION", fmt::format("'{:g}'", cost));
        double& here = matrix_[row * count + col];  // of a full matrix, set when the other row was read
        if (full && col < row && here != cost) fail_here("a matrix that is not symmetric");
        here = matrix_[col * count + row] = cost;
      }
    }
  }

  GraphMap build() {
    const std::string& type = header_["TYPE"];
    if (type != "OP" && type != "TSP") fail("bad TYPE: OP or TSP", in_quotes(type));
    if (type == "OP") {
      for (const char* const needed : {"COST_LIMIT", "NODE_SCORE_SECTION", "DEPOT_SECTION"}) {
        if (!header_.contains(needed)) fail(fmt::format("{} is missing", needed));
      }
      if (task_.start == kNoNode) fail("DEPOT_SECTION names no depot");
    }
    return {.graph = Graph::complete(nodes_, pair_costs(), options_.progress),
            .blocked = std::vector<bool>(nodes_),
            .labels = labels_from_one(nodes_),
            .prizes = std::move(prizes_),
            .places = {.points = std::move(places_), .unit = {}},
            .task = task_};
  }

  std::shared_ptr<const PairCosts> pair_costs() {
    const std::string& type = header_["EDGE_WEIGHT_TYPE"];
    if (type == "EXPLICIT") {
      if (matrix_.empty()) fail("EDGE_WEIGHT_SECTION is missing");
      return std::make_shared<MatrixCosts>(nodes_, std::move(matrix_));
    }
    const auto* const distance = std::ranges::find(kDistances, type);
    if (distance == std::end(kDistances)) {
      fail("bad EDGE_WEIGHT_TYPE: EUC_2D, CEIL_2D, GEO, ATT or EXPLICIT", in_quotes(type));
    }
    if (points_.empty()) fail("NODE_COORD_SECTION is missing");
    return std::make_shared<PlaneCosts>(static_cast<Distance>(distance - kDistances), std::move(points_));
  }

  struct Section {
    std::string name;
    std::size_t begin;  // behind its name
    std::size_t end;    // of the next keyword
  };

  std::string_view text_;
  const std::string& source_;
  const MapOptions& options_;
  std::size_t at_ = 0;
  NodeId nodes_ = 0;
  std::vector<Section> sections_;
  std::map<std::string, std::string> header_;  // and the sections met
  GivenTask task_;
  std::vector<Point> points_;  // that costs are computed from
  std::vector<Point> places_;  // the same, or how the file is drawn
  std::vector<double> prizes_;
  std::vector<double> matrix_;  // [N, N]
};

}  // namespace

bool is_tsplib(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  const std::string_view first = text.substr(0, text.find_first_of(kKeywordEnds));
  return is_keyword(first) || first.ends_with("_SECTION");
}

GraphMap parse_tsplib(std::string_view text, const std::string& source, const MapOptions& options) {
  return TsplibReader(text, source, options).read();
}

}  // namespace graphdrl
