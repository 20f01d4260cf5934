#include <memory>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/env/vector_env.h"
#include "graphdrl/nn/paper_features.h"

namespace graphdrl::python {
namespace {

// Episodes of one grid side by side, with the paper's features, in arrays that stay the same and are written anew by
// every call.
class GridEpisodes {
 public:
  // start: a node, or kNoNode for a random one. Throws Error as Episode does, and where no step can be taken.
  GridEpisodes(const World& world, const EpisodeOptions& options, std::int64_t start, int count, bool restarts)
      : encoder_(world),
        episodes_(world, options, count),
        start_(start == kNoNode ? kNoNode : checked_node(world, start, "start")),
        restarts_(restarts),
        width_(static_cast<std::size_t>(world.node_count()) * kPaperFeatureCount),
        random_(count, Rng(0)),
        over_(count, true),
        features_(width_ * count),
        rewards_(count),
        terminated_(std::make_unique<bool[]>(count)),
        truncated_(std::make_unique<bool[]>(count)),
        visited_(count),
        positions_(count) {
    if (!(options.budget >= 1)) throw Error({.what = "bad budget", .expected = "1 or more, for a step"});
  }

  void seed(int index, std::uint64_t seed) { random_[checked(index)] = Rng(seed); }

  // Begins new episodes, of those with a true in `mask`; at `start` where that is a node.
  void reset(const InArray<bool, nb::ndim<1>>& mask, std::int64_t start) {
    if (mask.size() != static_cast<std::size_t>(episodes_.size())) throw Error({.what = "bad length of a mask"});
    const NodeId node = start == kNoNode ? kNoNode : checked_node(world(), start, "start");
    for (int i = 0; i < episodes_.size(); ++i) {
      if (mask.data()[i]) begin(i, episodes_[i], node);
    }
  }

  // One step of each. Where an episode is over, a new one begins instead: gymnasium's autoreset NEXT_STEP.
  void step(const InArray<std::int64_t, nb::ndim<1>>& actions) {
    if (actions.size() != static_cast<std::size_t>(episodes_.size())) {
      throw Error({.what = "bad number of actions",
                   .expected = std::to_string(episodes_.size()),
                   .got = std::to_string(actions.size())});
    }
    for (std::size_t i = 0; i < actions.size(); ++i) {
      if (actions.data()[i] >= 0 && actions.data()[i] < kActions) continue;
      throw Error({.what = "bad action", .expected = "0 to 3", .got = std::to_string(actions.data()[i])});
    }
    if (!restarts_ && over_[0]) throw Error({.what = "the episode is over", .expected = "reset() first"});
    const nb::gil_scoped_release unlocked;
    episodes_.for_each([&](int i, Episode& episode) {
      if (over_[i] != 0) {
        begin(i, episode, kNoNode);
      } else {
        walk_on(i, episode, static_cast<int>(actions.data()[i]));
      }
    });
  }

  const World& world() const { return episodes_[0].world(); }
  std::vector<NodeId> walk(int index) const { return episodes_[checked(index)].walk(); }

  // Views of the arrays, which live as long as this does.
  auto features() { return nb::ndarray<nb::numpy, float, nb::ndim<2>>(features_.data(), {count(), width_}); }
  auto rewards() { return nb::ndarray<nb::numpy, double, nb::ndim<1>>(rewards_.data(), {count()}); }
  auto terminated() { return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(terminated_.get(), {count()}); }
  auto truncated() { return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(truncated_.get(), {count()}); }
  auto visited() { return nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>(visited_.data(), {count()}); }
  auto positions() { return nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>(positions_.data(), {count()}); }

 private:
  static constexpr int kActions = static_cast<int>(kAllDirections.size());

  std::size_t count() const { return static_cast<std::size_t>(episodes_.size()); }
  int checked(int index) const {
    if (index < 0 || index >= episodes_.size()) throw Error({.what = "no such environment"});
    return index;
  }
  std::span<float> features_of(int i) { return {features_.data() + width_ * i, width_}; }

  void begin(int i, Episode& episode, NodeId start) {
    const auto nodes = world().valid_nodes();
    if (start == kNoNode) start = start_;
    if (start == kNoNode) start = nodes[random_[i].below(static_cast<std::uint32_t>(nodes.size()))];
    episode.reset(start);
    encoder_.begin(start, features_of(i));
    rewards_[i] = 0;
    terminated_[i] = truncated_[i] = false;
    over_[i] = 0;
    tell(i, episode);
  }

  void walk_on(int i, Episode& episode, int action) {
    const NodeId from = episode.position();
    const StepResult result = episode.step(action);
    encoder_.update(from, episode.position(), result, features_of(i));
    rewards_[i] = result.reward;
    terminated_[i] = episode.terminal();
    truncated_[i] = !terminated_[i] && episode.done();
    over_[i] = static_cast<std::uint8_t>(terminated_[i] || truncated_[i]);
    tell(i, episode);
  }

  void tell(int i, const Episode& episode) {
    visited_[i] = episode.visited_count();
    positions_[i] = episode.position();
  }

  PaperFeatureEncoder encoder_;
  VectorEnv episodes_;
  NodeId start_;
  bool restarts_;
  std::size_t width_;
  std::vector<Rng> random_;  // [n]
  std::vector<std::uint8_t> over_;
  std::vector<float> features_;  // [n, N F]
  std::vector<double> rewards_;  // [n], as all that follow
  std::unique_ptr<bool[]> terminated_;
  std::unique_ptr<bool[]> truncated_;
  std::vector<std::int64_t> visited_;
  std::vector<std::int64_t> positions_;
};

}  // namespace

void bind_environments(nb::module_& module) {
  nb::class_<GridEpisodes>(module, "GridEpisodes", "Episodes of one grid side by side, with the paper's features.")
      .def(
          "__init__",
          [](GridEpisodes* self, const World& world, double budget, bool coverage_gain, bool end_at_full_coverage,
             bool punish_blocked_by_visits, std::int64_t start, int count, bool restarts) {
            if (count < 1) throw Error({.what = "bad number of environments", .expected = "1 or more"});
            const EpisodeOptions options{
                .budget = budget,
                .reward = coverage_gain ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty,
                .end_at_full_coverage = end_at_full_coverage,
                .punish_blocked_by_visits = punish_blocked_by_visits};
            new (self) GridEpisodes(world, options, start, count, restarts);
          },
          nb::arg("world"), nb::arg("budget"), nb::arg("coverage_gain"), nb::arg("end_at_full_coverage"),
          nb::arg("punish_blocked_by_visits"), nb::arg("start"), nb::arg("count"), nb::arg("restarts"))
      .def("seed", &GridEpisodes::seed, nb::arg("index"), nb::arg("seed"))
      .def("reset", &GridEpisodes::reset, nb::arg("mask"), nb::arg("start"))
      .def("step", &GridEpisodes::step, nb::arg("actions"))
      .def(
          "walk", [](const GridEpisodes& self, int index) { return to_numpy(self.walk(index)); }, nb::arg("index"),
          nb::rv_policy::automatic)
      .def_prop_ro("features", &GridEpisodes::features)
      .def_prop_ro("rewards", &GridEpisodes::rewards)
      .def_prop_ro("terminated", &GridEpisodes::terminated)
      .def_prop_ro("truncated", &GridEpisodes::truncated)
      .def_prop_ro("visited", &GridEpisodes::visited)
      .def_prop_ro("positions", &GridEpisodes::positions);
}

}  // namespace graphdrl::python
