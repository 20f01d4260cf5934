#include "bindings.h"
#include "graphdrl/env/graph_episodes.h"
#include "graphdrl/env/unknown_episodes.h"
#include "graphdrl/nn/feature_episodes.h"
#include "graphdrl/report/picture.h"

namespace graphdrl::python {
namespace {

// Views of the arrays of episodes, which live as long as those do.
template <typename T>
auto column(std::span<T> values) {
  return nb::ndarray<nb::numpy, T, nb::ndim<1>>(values.data(), {values.size()});
}
template <typename T>
auto rows(const Episodes& episodes, std::span<T> values) {
  const auto count = static_cast<std::size_t>(episodes.count());
  return nb::ndarray<nb::numpy, T, nb::ndim<2>>(values.data(), {count, values.size() / count});
}

// Nodes, costs and links, in the order of spaces.GraphInstance.
auto arrays_of(GraphObservation seen, int features) {
  return std::tuple(to_numpy(std::move(seen.nodes), static_cast<std::size_t>(features)),
                    to_numpy(std::move(seen.costs), 1), to_numpy(std::move(seen.links), 2));
}

void bind_options(nb::module_& module) {
  nb::class_<EpisodesOptions>(module, "EpisodesOptions")
      .def(
          "__init__",
          [](EpisodesOptions* self, std::optional<World> world, std::string family, int size, bool weighted,
             bool directed, const std::string& budget, NodeId start, bool coverage_gain, bool return_to_start,
             const std::string& reveal, const std::string& score, int count, bool restarts) {
            new (self) EpisodesOptions{
                .world = std::move(world),
                .budget = Budget::parse(budget),
                .family = {.family = std::move(family), .size = size, .weighted = weighted, .directed = directed},
                .start = start,
                .episode = {.end = return_to_start ? End::at_start() : End::anywhere(),
                            .reward = coverage_gain ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty,
                            .reveal = Reveal::parse(reveal),
                            .score = parse_score(score)},
                .count = count,
                .restarts = restarts};
          },
          nb::kw_only(), nb::arg("world").none(), nb::arg("family"), nb::arg("size"), nb::arg("weighted"),
          nb::arg("directed"), nb::arg("budget"), nb::arg("start"), nb::arg("coverage_gain"),
          nb::arg("return_to_start"), nb::arg("reveal"), nb::arg("score"), nb::arg("count"), nb::arg("restarts"),
          "A world or, without one, a family; a start of -1 is a random one.");
}

void bind_episodes(nb::module_& module) {
  nb::class_<Episodes>(module, "Episodes", "Episodes side by side, in arrays that every call writes anew.")
      .def("seed", &Episodes::seed, nb::arg("index"), nb::arg("seed"))
      .def(
          "reset",
          [](Episodes& self, const InArray<bool, nb::ndim<1>>& mask, NodeId start) {
            self.reset(values_of<bool>(mask), start);
          },
          nb::arg("mask"), nb::arg("start"))
      .def(
          "step",
          [](Episodes& self, const InArray<std::int64_t, nb::ndim<1>>& actions) {
            const nb::gil_scoped_release unlocked;
            self.step(values_of<std::int64_t>(actions));
          },
          nb::arg("actions"))
      .def(
          "world", [](const Episodes& self, int index) { return self.episode(index).world(); }, nb::arg("index"))
      .def(
          "walk", [](const Episodes& self, int index) { return to_numpy(self.episode(index).walk_in_world()); },
          nb::arg("index"), nb::rv_policy::automatic)
      .def(
          "spent", [](const Episodes& self, int index) { return self.episode(index).spent(); }, nb::arg("index"))
      .def_prop_ro("observations", [](Episodes& self) { return rows(self, self.observations()); })
      .def_prop_ro("action_masks", [](Episodes& self) { return rows(self, self.action_masks()); })
      .def_prop_ro("targets", [](Episodes& self) { return rows(self, self.targets()); })
      .def_prop_ro("rewards", [](Episodes& self) { return column(self.rewards()); })
      .def_prop_ro("terminated", [](Episodes& self) { return column(self.terminated()); })
      .def_prop_ro("truncated", [](Episodes& self) { return column(self.truncated()); })
      .def_prop_ro("visited", [](Episodes& self) { return column(self.visited()); })
      .def_prop_ro("positions", [](Episodes& self) { return column(self.positions()); });
  nb::class_<GridEpisodes, Episodes>(module, "GridEpisodes")
      .def(nb::init<EpisodesOptions>(), nb::arg("options"))
      .def_prop_ro(
          "highest_features",
          [](const GridEpisodes& self) {
            const auto highest = self.highest_features();
            return to_numpy(std::vector<float>(highest.begin(), highest.end()));
          },
          nb::rv_policy::automatic);
  nb::class_<GraphEpisodes, Episodes>(module, "GraphEpisodes")
      .def(nb::init<EpisodesOptions, int>(), nb::arg("options"), nb::arg("max_neighbours"))
      .def(
          "graph",
          [](const GraphEpisodes& self, int index) { return arrays_of(self.graph(index), kGraphNodeFeatureCount); },
          nb::arg("index"));
  nb::class_<FirstVisitEpisodes, Episodes>(module, "FirstVisitEpisodes")
      .def(nb::init<EpisodesOptions, int>(), nb::arg("options"), nb::arg("max_visits"))
      .def(
          "graph",
          [](const FirstVisitEpisodes& self, int index) {
            return arrays_of(self.graph(index), kExplorerNodeFeatureCount);
          },
          nb::arg("index"))
      .def(
          "target_rows", [](const FirstVisitEpisodes& self, int index) { return to_numpy(self.target_rows(index)); },
          nb::arg("index"), nb::rv_policy::automatic);
  nb::class_<UnknownEpisodes, Episodes>(module, "UnknownEpisodes")
      .def(nb::init<EpisodesOptions, int>(), nb::arg("options"), nb::arg("max_visits"))
      .def(
          "graph",
          [](UnknownEpisodes& self, int index) { return arrays_of(self.graph(index), kUnknownNodeFeatureCount); },
          nb::arg("index"))
      .def_prop_ro("seen", [](UnknownEpisodes& self) { return column(self.seen()); });
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
  bind_options(module);
  bind_episodes(module);
  module.def("picture_of", &picture_of, nb::arg("world"), nb::arg("walk"), nb::rv_policy::automatic,
             "A picture of a walk: [rows, columns, 3] pixels.");
  module.attr("GRAPH_NODE_FEATURES") = kGraphNodeFeatureCount;
  module.attr("EXPLORER_NODE_FEATURES") = kExplorerNodeFeatureCount;
  module.attr("UNKNOWN_NODE_FEATURES") = kUnknownNodeFeatureCount;
  nb::list grids;
  for (const WorldFamily& family : world_families()) {
    if (family.grid) grids.append(nb::str(family.name.data(), family.name.size()));
  }
  module.attr("GRID_FAMILIES") = grids;
}

}  // namespace graphdrl::python
