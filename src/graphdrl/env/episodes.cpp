#include "graphdrl/env/episodes.h"

#include <fmt/format.h>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

constexpr int kMostEpisodes = 1'000'000;

}  // namespace

bool EpisodesOptions::is_grid() const {
  return world ? world->is_grid() : family_of(family).grid;
}

NodeId EpisodesOptions::most_nodes() const {
  if (world) return world->node_count();
  return is_grid() ? family.size * family.size : family.size;
}

Episodes::Episodes(EpisodesOptions options, ActionSpace actions) : options_(std::move(options)) {
  if (options_.count < 1 || options_.count > kMostEpisodes) {
    throw Error({.what = "bad number of environments",
                 .expected = fmt::format("1 to {}", kMostEpisodes),
                 .got = fmt::format("{}", options_.count)});
  }
  options_.episode.action_space = actions;
  slots_ = std::vector<Slot>(static_cast<std::size_t>(options_.count));
  Rng rng(0);
  Episode example = new_episode(rng);
  if (options_.start != kNoNode) example.reset(options_.start);
}

void Episodes::allocate(std::size_t width, int actions) {
  width_ = width;
  actions_ = static_cast<std::size_t>(actions);
  const std::size_t count = slots_.size();
  observations_.resize(width_ * count);
  masks_ = std::make_unique<bool[]>(actions_ * count);
  targets_.assign(actions_ * count, kNoNode);
  rewards_.resize(count);
  terminated_ = std::make_unique<bool[]>(count);
  truncated_ = std::make_unique<bool[]>(count);
  visited_.resize(count);
  positions_.resize(count);
}

Episode Episodes::new_episode(Rng& rng) const {
  const World world = options_.draw_world(rng);
  EpisodeOptions options = options_.episode;
  options.budget = options_.budget.cost_in(world);
  return Episode(world, options);
}

void Episodes::seed(int index, std::uint64_t seed) {
  slots_.at(static_cast<std::size_t>(index)).rng = Rng(seed);
}

const Episode& Episodes::episode(int index) const {
  const auto& episode = slots_.at(static_cast<std::size_t>(index)).episode;
  if (!episode) throw Error({.what = "no episode yet", .expected = "reset() first"});
  return *episode;
}

void Episodes::reset(std::span<const bool> mask, NodeId start) {
  if (mask.size() != slots_.size()) throw Error({.what = "bad length of a mask"});
  for (int i = 0; i < count(); ++i) {
    if (mask[i]) begin(i, start);
  }
}

void Episodes::step(std::span<const std::int64_t> actions) {
  if (actions.size() != slots_.size()) {
    throw Error({.what = "bad number of actions",
                 .expected = fmt::format("{}", slots_.size()),
                 .got = fmt::format("{}", actions.size())});
  }
  for (const std::int64_t action : actions) {
    if (action >= 0 && action < static_cast<std::int64_t>(actions_)) continue;
    throw Error(
        {.what = "bad action", .expected = fmt::format("0 to {}", actions_ - 1), .got = fmt::format("{}", action)});
  }
  if (!options_.restarts && std::ranges::any_of(slots_, &Slot::over)) {
    throw Error({.what = "the episode is over", .expected = "reset() first"});
  }
  for_each([&](int i) {
    if (over(i)) {
      begin(i);
    } else {
      act(i, static_cast<int>(actions[i]));
    }
  });
}

void Episodes::begin(int index, NodeId start) {
  if (start != kNoNode && !options_.world) throw Error({.what = "a random world has no start to choose"});
  Slot& slot = slots_[index];
  slot.over = true;  // until all is shown: what follows may throw
  if (!slot.episode || !options_.world) slot.episode.emplace(new_episode(slot.rng));
  Episode& episode = *slot.episode;
  const auto nodes = episode.world().valid_nodes();
  if (start == kNoNode) start = options_.start;
  if (start == kNoNode) start = nodes[slot.rng.below(static_cast<std::uint32_t>(nodes.size()))];
  // In each episode the nodes of an unknown world have other numbers.
  episode.reset(start, episode.hidden() ? slot.rng.next() : 0);
  show_start(index, episode);
  rewards_[index] = 0;
  terminated_[index] = truncated_[index] = false;
  slot.over = false;
  tell(index);
}

void Episodes::act(int index, int action) {
  Slot& slot = slots_[index];
  const Outcome outcome = take(index, *slot.episode, action);
  rewards_[index] = outcome.reward;
  terminated_[index] = outcome.terminated;
  truncated_[index] = !outcome.terminated && outcome.truncated;
  slot.over = outcome.terminated || outcome.truncated;
  tell(index);
}

void Episodes::tell(int index) {
  visited_[index] = slots_[index].episode->visited_count();
  positions_[index] = slots_[index].episode->position();
}

Episodes::Outcome Episodes::waste(Episode& episode) {
  if (!episode.can_stay()) return {.terminated = true};
  return {.reward = episode.stay().reward};
}

GraphObservation observation_on(const Graph& graph, double mean_cost, std::vector<float> nodes) {
  GraphObservation seen{.nodes = std::move(nodes), .costs = {}, .links = {}};
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    const auto neighbours = graph.neighbours(node);
    for (int a = 0; a < std::ssize(neighbours); ++a) {
      seen.links.insert(seen.links.end(), {node, neighbours[a]});
      seen.costs.push_back(static_cast<float>(graph.cost(node, a) / mean_cost));
    }
  }
  return seen;
}

}  // namespace graphdrl
