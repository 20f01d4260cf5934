#include "graphdrl/train/online_lessons.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graphdrl/env/episode.h"
#include "graphdrl/planners/online_explorer.h"
#include "graphdrl/planners/rules.h"

namespace graphdrl {
namespace {

// Where there is no budget, a walk that costs as much as one mean edge a node is worth this much less than one that
// costs nothing, in % of the nodes. Chosen so that values vary about as much as those of coverage.
constexpr double kWorthOfAll = 60;
constexpr float kMostApart = 8;  // values are cut so far from their mean, in % of the nodes
constexpr int kFirstValued = 4;  // the leader's choice, and those that the network ranks highest

void go_on(Episode& episode, Policy& policy) {
  int action = kStop;
  while (!episode.done()) {
    const Observation now = episode.observation();
    policy.act({&now, 1}, {&action, 1});
    if (action == kStop) return;
    episode.step(action);
  }
}

void walk_along(Episode& episode, std::span<const NodeId> way) {
  for (const NodeId node : way) episode.step(episode.observation().action_to(node));
}

class Lessons {
 public:
  Lessons(const OnlineLessonOptions& options, const OnlineParameters& parameters, std::uint64_t seed)
      : options_(options),
        parameters_(parameters),
        rng_(seed),
        world_(random_world(options.worlds[seed % options.worlds.size()], rng_)),
        // No ownership: the parameters stay the caller's.
        network_policy_(SharedOnlineExplorer(std::shared_ptr<void>(), &parameters)),
        rules_{RulePolicy(Rule::kPocket), RulePolicy(Rule::kOpen)} {}

  std::vector<OnlineLesson> draw() {
    const auto chance = [&](double p) { return rng_.uniform() < p; };
    unlimited_ = chance(options_.unlimited);
    whole_ = world_.valid_count() * world_.open().mean_cost();
    const double ratio = options_.least_budget + (options_.most_budget - options_.least_budget) * rng_.uniform();
    const double budget = unlimited_ ? kNoLimit : ratio * whole_;
    const End end = chance(options_.home) ? End::at_start() : End::anywhere();
    const NodeId start = world_.valid_nodes()[rng_.index(world_.valid_count())];
    Episode episode(
        world_, Task(world_, start, budget, end),
        {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges"), .numbers_seed = rng_.next()});
    const bool by_network = chance(options_.lead);
    RulePolicy& rule = rules_[rng_.index(2)];
    Policy& leader = by_network ? static_cast<Policy&>(network_policy_) : rule;
    const double share = options_.states_per_walk / (std::min(unlimited_ ? 1 : ratio, 1.0) * world_.valid_count());
    std::vector<OnlineLesson> lessons;
    while (!episode.done()) {
      const Observation now = episode.observation();
      int action = kStop;
      leader.act({&now, 1}, {&action, 1});
      if (action == kStop) break;
      if (!decided_at(episode) || !chance(share)) {
        episode.step(action);
        continue;
      }
      const NodeId choice = value_state(episode, lessons);
      // A way goes on to where it leads: the leader finds its way from there.
      if (choice == kNoNode || !chance(options_.explore)) {
        episode.step(action);
      } else {
        walk_along(episode, way_to(episode, choice));
      }
    }
    return lessons;
  }

 private:
  // Whether the node has just been visited for the first time, so that there is something new to decide upon.
  static bool decided_at(const Episode& episode) { return episode.visits()[episode.position()] == 1; }

  std::vector<NodeId> way_to(const Episode& episode, NodeId node) {
    std::vector<NodeId> way;
    find_way(episode.view().open(), episode.position(), node, episode.observation().ground(), search_);
    search_.append_path_to(node, way);
    return way;
  }

  // In % of the nodes.
  double worth(const Episode& ended) const {
    if (unlimited_) return -kWorthOfAll * ended.spent() / whole_;
    return 100 * ended.prize() / world_.total_prize();
  }

  double value(const Episode& episode, NodeId node) {
    Episode first = episode.fork();
    walk_along(first, way_to(first, node));
    if (!options_.by_rules) {
      go_on(first, network_policy_);
      return worth(first);
    }
    double best = -kNoLimit;
    for (RulePolicy& rule : rules_) {
      Episode tried = first.fork();
      go_on(tried, rule);
      best = std::max(best, worth(tried));
    }
    return best;
  }

  // Appends the state's lesson; gives a first visit drawn from those valued, kNoNode where there is no choice.
  NodeId value_state(const Episode& episode, std::vector<OnlineLesson>& lessons) {
    const Observation now = episode.observation();
    const Exploration state(now, now.ground());
    rows_.clear();
    const auto found = encode_online(state, now.task->budget(), now.spent, scratch_, search_, rows_);
    if (found.size() < 2) return kNoNode;
    const std::vector<FirstVisit> visits(found.begin(), found.end());
    score_.resize(visits.size());
    network_.forward(parameters_, rows_, score_);
    std::vector<std::size_t> order(visits.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return score_[a] > score_[b]; });
    for (std::size_t i = kFirstValued; i + 1 < order.size(); ++i) {
      std::swap(order[i], order[i + rng_.below(static_cast<std::uint32_t>(order.size() - i))]);
    }
    // Those that the rules would choose are among the first two where there are many [kOnlineVisits].
    for (const std::size_t rule_choice : {std::size_t{1}, std::size_t{0}}) {
      const auto place = std::ranges::find(order, rule_choice);
      std::rotate(order.begin(), place, place + 1);
    }
    order.resize(std::min<std::size_t>(order.size(), options_.most_valued));
    OnlineLesson lesson;
    for (const std::size_t i : order) {
      const auto row = rows_.begin() + static_cast<std::ptrdiff_t>(i) * kOnlineFeatureCount;
      lesson.rows.insert(lesson.rows.end(), row, row + kOnlineFeatureCount);
      lesson.value.push_back(static_cast<float>(value(episode, visits[i].node)));
    }
    const float mean =
        std::accumulate(lesson.value.begin(), lesson.value.end(), 0.0f) / static_cast<float>(lesson.value.size());
    for (float& of_visit : lesson.value) of_visit = std::clamp(of_visit - mean, -kMostApart, kMostApart);
    lessons.push_back(std::move(lesson));
    return visits[order[rng_.below(static_cast<std::uint32_t>(order.size()))]].node;
  }

  const OnlineLessonOptions& options_;
  const OnlineParameters& parameters_;
  Rng rng_;
  World world_;
  OnlineExplorerPolicy network_policy_;
  RulePolicy rules_[2];
  bool unlimited_ = false;
  double whole_ = 0;
  OnlineNetwork network_;
  OnlineScratch scratch_;
  NearestFirst search_;
  std::vector<float> rows_;
  std::vector<float> score_;
};

}  // namespace

std::vector<OnlineLesson> draw_online_lessons(const OnlineLessonOptions& options, const OnlineParameters& parameters,
                                              std::uint64_t seed) {
  return Lessons(options, parameters, seed).draw();
}

}  // namespace graphdrl
