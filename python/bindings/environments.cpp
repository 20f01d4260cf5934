#include <algorithm>

#include "episodes.h"
#include "graphdrl/base/error.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/planners/explorer.h"
#include "graphdrl/report/picture.h"

namespace graphdrl::python {
namespace {

// The paper's decision process on a grid: directions, and its features of each cell.
class GridEpisodes final : public Episodes {
 public:
  // cells: of each world.
  GridEpisodes(const Setting& setting, int count, bool restarts, int cells)
      : Episodes(setting, count, restarts, static_cast<std::size_t>(cells) * kPaperFeatureCount, kActions),
        encoders_(static_cast<std::size_t>(count)) {
    for (int i = 0; i < count; ++i) std::ranges::fill(mask_of(i), true);  // directions are never masked
    if (!setting.world) return;
    const auto encoder = std::make_shared<const PaperFeatureEncoder>(*setting.world);
    std::fill(encoders_.begin(), encoders_.end(), encoder);
  }

 private:
  static constexpr int kActions = static_cast<int>(kAllDirections.size());

  void begun(int i, const Episode& episode) override {
    if (encoders_[i] == nullptr || !(encoders_[i]->view() == View(episode.world()))) {
      encoders_[i] = std::make_shared<const PaperFeatureEncoder>(episode.world());
    }
    encoders_[i]->begin(episode.position(), observation_of(i));
  }

  Outcome act(int i, Episode& episode, int action) override {
    const NodeId from = episode.position();
    const StepResult step = episode.step(action);
    encoders_[i]->update(from, episode.position(), step, observation_of(i));
    return {.reward = step.reward, .terminated = episode.terminal(), .truncated = episode.done()};
  }

  std::vector<std::shared_ptr<const PaperFeatureEncoder>> encoders_;  // [n]
};

// A graph as rows of features and edges, for networks on graphs.
using GraphArrays = std::tuple<nb::ndarray<nb::numpy, float, nb::ndim<2>>, nb::ndarray<nb::numpy, float, nb::ndim<2>>,
                               nb::ndarray<nb::numpy, std::int64_t, nb::ndim<2>>>;

// nodes: [n, features]. Edges both ways, with their costs in mean edges.
GraphArrays graph_arrays(const Graph& graph, std::vector<float> nodes, std::size_t features, double unit) {
  std::vector<float> costs;
  std::vector<std::int64_t> links;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    const auto neighbours = graph.neighbours(node);
    for (int a = 0; a < std::ssize(neighbours); ++a) {
      links.insert(links.end(), {node, neighbours[a]});
      costs.push_back(static_cast<float>(graph.cost(node, a) / unit));
    }
  }
  return {to_numpy(std::move(nodes), features), to_numpy(std::move(costs), 1), to_numpy(std::move(links), 2)};
}

// A masked action where actions are neighbours or first visits: it leads nowhere, at the cost of a mean edge, as a
// blocked direction does; where that cannot be paid for, the episode is over.
double waste(Episode& episode, bool& over) {
  if (episode.can_stay()) return episode.stay().reward;
  over = true;
  return 0;
}

// Any graph: an action is a neighbour, in the order of their numbers.
class GraphEpisodes final : public Episodes {
 public:
  static constexpr int kNodeFeatures = 4;
  static constexpr int kActionFeatures = 5;
  static constexpr int kGlobals = 2;
  static constexpr int kGraphFeatures = 6;
  static constexpr float kDearest = 8;  // mean edges; a dearer edge looks as dear

  GraphEpisodes(const Setting& setting, int count, bool restarts, int nodes, int neighbours)
      : Episodes(setting, count, restarts,
                 static_cast<std::size_t>(nodes) * kNodeFeatures + std::size_t{kActionFeatures} * neighbours + kGlobals,
                 neighbours),
        nodes_(nodes),
        neighbours_(neighbours) {}

  GraphArrays graph(int index) const {
    const Episode& at = episode(index);
    const Observation now = at.observation();
    const World& world = at.world();
    std::vector<float> rows;
    for (NodeId node = 0; node < world.node_count(); ++node) {
      const auto flags = node_row(at, node);
      const int action = now.action_to(node);
      const bool legal = action != kNoAction && now.legal(action);
      rows.insert(rows.end(), flags.begin(), flags.end());
      rows.insert(rows.end(), {legal ? 1.0f : 0.0f, budget_left(now)});
    }
    return graph_arrays(world.open(), std::move(rows), kGraphFeatures, world.open().mean_cost());
  }

 private:
  // Open, visited, current, prize.
  static std::array<float, kNodeFeatures> node_row(const Episode& at, NodeId node) {
    const World& world = at.world();
    const bool open = !world.is_blocked(node);
    return {open ? 1.0f : 0.0f, at.visits()[node] > 0 ? 1.0f : 0.0f, at.position() == node ? 1.0f : 0.0f,
            open ? prize_of(world, node) : 0.0f};
  }
  // In mean prizes, up to 8 of them as 1.
  static float prize_of(const World& world, NodeId node) {
    const double mean = world.total_prize() / world.valid_count();
    return mean > 0 ? static_cast<float>(std::min(world.prize(node) / mean / 8, 1.0)) : 0.0f;
  }
  static float budget_left(const Observation& now) {
    return now.task->budget() > 0 ? static_cast<float>(std::clamp(1 - now.spent / now.task->budget(), 0.0, 1.0)) : 0.0f;
  }

  void begun(int i, const Episode& episode) override {
    const World& world = episode.world();
    if (world.node_count() > nodes_) throw Error({.what = "a world of too many nodes", .where = world.name()});
    for (const NodeId node : world.valid_nodes()) {
      const auto degree = std::ssize(world.open_neighbours(node));
      if (degree <= neighbours_) continue;
      throw Error({.what = "a node of " + std::to_string(degree) + " neighbours",
                   .expected = "at most max_neighbours = " + std::to_string(neighbours_),
                   .where = world.name()});
    }
    const std::span<float> out = observation_of(i);
    std::fill(out.begin(), out.end(), 0.0f);
    for (NodeId node = 0; node < world.node_count(); ++node) show_node(i, episode, node);
    show_moves(i, episode);
  }

  Outcome act(int i, Episode& episode, int action) override {
    const NodeId from = episode.position();
    bool over = false;
    double reward = 0;
    if (mask_of(i)[static_cast<std::size_t>(action)]) {
      reward = episode.step(action).reward;
      show_node(i, episode, from);
      show_node(i, episode, episode.position());
    } else {
      reward = waste(episode, over);
    }
    show_moves(i, episode);
    return {.reward = reward,
            .terminated = over || episode.done() || episode.observation().all_visited(),
            .truncated = false};
  }

  void show_node(int i, const Episode& episode, NodeId node) {
    const auto row = node_row(episode, node);
    std::copy(row.begin(), row.end(), observation_of(i).data() + static_cast<std::ptrdiff_t>(node) * kNodeFeatures);
  }

  // Of each action: legal, visited, cost, prize, unvisited neighbours there; and what is left, and what is visited.
  void show_moves(int i, const Episode& episode) {
    const Observation now = episode.observation();
    const World& world = episode.world();
    const std::span<bool> mask = mask_of(i);
    const std::span<std::int64_t> targets = targets_of(i);
    float* out = observation_of(i).data() + static_cast<std::ptrdiff_t>(nodes_) * kNodeFeatures;
    std::fill_n(out, kActionFeatures * neighbours_, 0.0f);
    std::fill(mask.begin(), mask.end(), false);
    std::fill(targets.begin(), targets.end(), kNoNode);
    for (int action = 0; action < now.action_count(); ++action) {
      const NodeId target = now.target(action);
      targets[action] = target;
      mask[action] = now.legal(action);
      const auto around = world.open_neighbours(target);
      const auto unvisited = std::count_if(around.begin(), around.end(), [&](NodeId n) { return !now.visited(n); });
      const double cost = now.cost(action) / world.open().mean_cost();
      float* const row = out + static_cast<std::ptrdiff_t>(action) * kActionFeatures;
      row[0] = mask[action] ? 1.0f : 0.0f;
      row[1] = now.visited(target) ? 1.0f : 0.0f;
      row[2] = std::min(static_cast<float>(cost), kDearest) / kDearest;
      row[3] = prize_of(world, target);
      row[4] = static_cast<float>(std::min<std::ptrdiff_t>(unvisited, 8)) / 8;
    }
    out += static_cast<std::ptrdiff_t>(kActionFeatures) * neighbours_;
    out[0] = budget_left(now);
    out[1] = static_cast<float>(now.visited_count) / static_cast<float>(world.valid_count());
  }

  int nodes_;
  int neighbours_;
};

// Any graph: an action is a first visit, a walk to an unvisited node next to visited ground, nearest first. What is
// seen of each is what the explorer sees [explorer_features.h].
class FirstVisitEpisodes final : public Episodes {
 public:
  static constexpr int kWidth = kExplorerVisitFeatureCount + 1;
  static constexpr float kMost = 16;  // features are cut at ±16

  FirstVisitEpisodes(const Setting& setting, int count, bool restarts, int visits)
      : Episodes(setting, count, restarts, std::size_t{kWidth} * visits, visits),
        visits_(visits),
        memories_(static_cast<std::size_t>(count)) {}

  GraphArrays graph(int index) const {
    const World& world = episode(index).world();
    const ExplorerBatch& seen = memories_[static_cast<std::size_t>(index)].seen;
    std::vector<float> rows = seen.node_x;
    for (float& value : rows) value = std::clamp(value, -kMost, kMost);
    return graph_arrays(seen.graphs.graph(0), std::move(rows), kExplorerNodeFeatureCount, world.open().mean_cost());
  }
  // Of each action the row of its target in that graph; -1 of those that there are not.
  OutArray<std::int64_t> target_rows(int index) const {
    const std::vector<int>& seen = memories_[static_cast<std::size_t>(index)].seen.target;
    std::vector<std::int64_t> rows(static_cast<std::size_t>(visits_), kNoNode);
    std::copy_n(seen.begin(), std::min(rows.size(), seen.size()), rows.begin());
    return to_numpy(std::move(rows));
  }

 private:
  struct Memory {
    NodeSet visited;
    ExplorerEncoder encoder;
    NearestFirst search;
    ExplorerBatch seen;
    std::vector<FirstVisit> visits;
  };

  void begun(int i, const Episode& episode) override {
    Memory& memory = memories_[static_cast<std::size_t>(i)];
    const Observation now = episode.observation();
    memory.visited = now.ground();
    show(i, episode);
  }

  Outcome act(int i, Episode& episode, int action) override {
    Memory& memory = memories_[static_cast<std::size_t>(i)];
    bool over = false;
    double reward = 0;
    if (mask_of(i)[static_cast<std::size_t>(action)]) {
      for (const NodeId node : way_to(memory, episode, memory.visits[static_cast<std::size_t>(action)].node)) {
        reward += episode.step(episode.observation().action_to(node)).reward;
      }
      memory.visited.insert(episode.position());
    } else {
      reward = waste(episode, over);
    }
    show(i, episode);
    return {.reward = reward, .terminated = over || memory.visits.empty(), .truncated = false};
  }

  // By the cheapest way through visited nodes, without the first of them.
  static std::vector<NodeId> way_to(Memory& memory, const Episode& episode, NodeId target) {
    memory.search.run(episode.world().open(), episode.position(), kNoLimit, [&](NodeId node, double) {
      if (node == target) return NearestFirst::Next::kEnd;
      return memory.visited.contains(node) ? NearestFirst::Next::kThrough : NearestFirst::Next::kPast;
    });
    std::vector<NodeId> walk = {episode.position()};
    memory.search.append_path_to(target, walk);
    walk.erase(walk.begin());
    return walk;
  }

  void show(int i, const Episode& episode) {
    Memory& memory = memories_[static_cast<std::size_t>(i)];
    const Observation now = episode.observation();
    memory.seen.clear();
    const Exploration state(now, memory.visited);
    const auto visits = memory.encoder.append(state, kExplorerScope, memory.seen);
    memory.visits.assign(visits.begin(), visits.end());
    if (visits.empty() && memory.encoder.overlooked()) {
      // The nearest, where all are too far off to be looked at: nothing is seen of it.
      const FirstVisit far = state.nearest_first_visit(memory.search);
      if (far.node != kNoNode) memory.visits.push_back(far);
    }
    const std::span<bool> mask = mask_of(i);
    const std::span<std::int64_t> targets = targets_of(i);
    const std::span<float> out = observation_of(i);
    std::fill(mask.begin(), mask.end(), false);
    std::fill(targets.begin(), targets.end(), kNoNode);
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::size_t v = 0; v < std::min(memory.visits.size(), mask.size()); ++v) {
      mask[v] = true;
      targets[v] = memory.visits[v].node;
      float* const row = out.data() + v * kWidth;
      row[0] = 1;
      for (std::size_t f = 0; f < kExplorerVisitFeatureCount && v < memory.seen.target.size(); ++f) {
        row[f + 1] = std::clamp(memory.seen.visit_x[v * kExplorerVisitFeatureCount + f], -kMost, kMost);
      }
    }
  }

  int visits_;
  std::vector<Memory> memories_;  // [n]
};

// world or family (name, size, weighted, directed), budget, start (-1: random), coverage gain as the reward, whether
// the walk must return to its start.
using SettingState =
    std::tuple<std::optional<World>, std::tuple<std::string, int, bool, bool>, std::string, std::int64_t, bool, bool>;

Setting setting_of(const SettingState& state, ActionSpace actions) {
  const auto& [world, family, budget, start, coverage_gain, returns] = state;
  const auto& [name, size, weighted, directed] = family;
  Setting setting{.world = world,
                  .family = {.family = name, .size = size, .weighted = weighted, .directed = directed},
                  .budget = Budget::parse(budget),
                  .start = static_cast<NodeId>(start)};
  if (world && start != kNoNode) setting.start = checked_node(*world, start, "start");
  setting.options.end = returns ? End::at_start() : End::anywhere();
  setting.options.action_space = actions;
  setting.options.reward = coverage_gain ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty;
  Rng rng(0);
  const World example = setting.world_for(rng);  // throws Error where there is no such family
  setting.options.budget = setting.budget.cost_in(example);
  Episode(example, setting.options);  // throws Error where they do not fit
  return setting;
}

void require_count(int count) {
  if (count < 1 || count > 1'000'000) {
    throw Error({.what = "bad number of environments", .expected = "1 to 1000000", .got = std::to_string(count)});
  }
}

nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<3>> picture_of(const World& world,
                                                             const InArray<NodeId, nb::ndim<1>>& walk) {
  const Bitmap bitmap = Picture(world, values_of<NodeId>(walk), world.name(), {}).pixels();
  auto* const owned = new std::vector<std::uint8_t>();
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<std::uint8_t>*>(p); });
  owned->reserve(3 * bitmap.pixels.size());
  for (const Colour colour : bitmap.pixels) owned->insert(owned->end(), {colour.red, colour.green, colour.blue});
  return {owned->data(), {static_cast<std::size_t>(bitmap.height), static_cast<std::size_t>(bitmap.width), 3}, owner};
}

}  // namespace

void bind_environments(nb::module_& module) {
  nb::class_<Episodes>(module, "Episodes", "Episodes side by side, in arrays that every call writes anew.")
      .def("seed", &Episodes::seed, nb::arg("index"), nb::arg("seed"))
      .def("reset", &Episodes::reset, nb::arg("mask"), nb::arg("start"))
      .def("step", &Episodes::step, nb::arg("actions"))
      .def("world", &Episodes::world, nb::arg("index"))
      .def(
          "walk", [](const Episodes& self, int index) { return to_numpy(self.episode(index).walk()); },
          nb::arg("index"), nb::rv_policy::automatic)
      .def(
          "spent", [](const Episodes& self, int index) { return self.episode(index).spent(); }, nb::arg("index"))
      .def_prop_ro("observations", &Episodes::observations)
      .def_prop_ro("action_masks", &Episodes::action_masks)
      .def_prop_ro("targets", &Episodes::targets)
      .def_prop_ro("rewards", &Episodes::rewards)
      .def_prop_ro("terminated", &Episodes::terminated)
      .def_prop_ro("truncated", &Episodes::truncated)
      .def_prop_ro("visited", &Episodes::visited)
      .def_prop_ro("positions", &Episodes::positions);
  nb::class_<GridEpisodes, Episodes>(module, "GridEpisodes")
      .def(
          "__init__",
          [](GridEpisodes* self, const SettingState& state, bool end_at_full_coverage, bool punish_blocked_by_visits,
             int count, bool restarts, int cells) {
            require_count(count);
            Setting setting = setting_of(state, ActionSpace::kDirections);
            if (!(setting.options.budget >= 1)) {
              throw Error({.what = "bad budget", .expected = "1 or more, for a step"});
            }
            setting.options.end_at_full_coverage = end_at_full_coverage;
            setting.options.punish_blocked_by_visits = punish_blocked_by_visits;
            new (self) GridEpisodes(setting, count, restarts, cells);
          },
          nb::arg("setting"), nb::arg("end_at_full_coverage"), nb::arg("punish_blocked_by_visits"), nb::arg("count"),
          nb::arg("restarts"), nb::arg("cells"));
  nb::class_<GraphEpisodes, Episodes>(module, "GraphEpisodes")
      .def(
          "__init__",
          [](GraphEpisodes* self, const SettingState& state, int count, bool restarts, int nodes, int neighbours) {
            require_count(count);
            new (self) GraphEpisodes(setting_of(state, ActionSpace::kNeighbours), count, restarts, nodes, neighbours);
          },
          nb::arg("setting"), nb::arg("count"), nb::arg("restarts"), nb::arg("nodes"), nb::arg("neighbours"))
      .def("graph", &GraphEpisodes::graph, nb::arg("index"));
  nb::class_<FirstVisitEpisodes, Episodes>(module, "FirstVisitEpisodes")
      .def(
          "__init__",
          [](FirstVisitEpisodes* self, const SettingState& state, int count, bool restarts, int visits) {
            require_count(count);
            new (self) FirstVisitEpisodes(setting_of(state, ActionSpace::kNeighbours), count, restarts, visits);
          },
          nb::arg("setting"), nb::arg("count"), nb::arg("restarts"), nb::arg("visits"))
      .def("graph", &FirstVisitEpisodes::graph, nb::arg("index"))
      .def("target_rows", &FirstVisitEpisodes::target_rows, nb::arg("index"), nb::rv_policy::automatic);
  module.def("picture_of", &picture_of, nb::arg("world"), nb::arg("walk"), nb::rv_policy::automatic,
             "A picture of a walk: [rows, columns, 3] pixels.");
  module.def(
      "budget_in", [](const World& world, const std::string& budget) { return Budget::parse(budget).cost_in(world); },
      nb::arg("world"), nb::arg("budget"), "A budget in units of cost.");
  module.attr("GRAPH_NODE_FEATURES") = GraphEpisodes::kGraphFeatures;
  module.attr("EXPLORER_NODE_FEATURES") = kExplorerNodeFeatureCount;
  nb::list grids;
  for (const WorldFamily& family : world_families()) {
    if (family.grid) grids.append(nb::str(family.name.data(), family.name.size()));
  }
  module.attr("GRID_FAMILIES") = grids;
}

}  // namespace graphdrl::python
