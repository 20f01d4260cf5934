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
// What a teacher gains over the others in the whole walk counts so much at each choice that it would make: what one
// choice brings drowns in the noise of values. Of 0, 0.1, 0.4 and 1.5, 0.1 and 0.4 gave the best policies, alike
// within the noise (docs/unknown.md).
constexpr double kTeacherWeight = 0.3;
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

// Of cells the graph alone: where cells show directions, the network is not asked [OnlineExplorerPolicy].
World draw_world(const OnlineLessonOptions& options, Rng& rng, std::uint64_t seed) {
  World world = random_world(options.worlds[seed % options.worlds.size()], rng);
  return world.has_cells() ? World(world.name(), world.to_map()) : world;
}

class Lessons {
 public:
  Lessons(const OnlineLessonOptions& options, const OnlineParameters& parameters, std::uint64_t seed)
      : options_(options),
        parameters_(parameters),
        rng_(seed),
        world_(draw_world(options, rng_, seed)),
        // No ownership: the parameters stay the caller's.
        network_policy_(SharedOnlineExplorer(std::shared_ptr<void>(), &parameters)),
        pocket_(Rule::kPocket),
        open_(Rule::kOpen),
        teachers_{{&pocket_}, {&open_}} {
    if (!options.by_rules) teachers_.push_back({&network_policy_});
  }

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
    try_teachers(episode);
    Policy& leader = chance(options_.lead) ? static_cast<Policy&>(network_policy_) : *best_;
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
  struct Teacher {
    Policy* policy;
    double gain = 0;  // of its whole walk over the teachers' mean, in % of the nodes
  };

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

  // Makes the whole walk by each teacher. The best goes on from first visits that are valued: where a rule beats the
  // network, what the network would make of one says little of what can be made of it.
  void try_teachers(const Episode& start) {
    double most = -kNoLimit;
    double sum = 0;
    for (Teacher& teacher : teachers_) {
      Episode walk = start.fork();
      go_on(walk, *teacher.policy);
      teacher.gain = worth(walk);
      sum += teacher.gain;
      if (teacher.gain <= most) continue;
      most = teacher.gain;
      best_ = teacher.policy;
    }
    for (Teacher& teacher : teachers_) teacher.gain -= sum / static_cast<double>(teachers_.size());
  }

  double value(const Episode& episode, NodeId node) {
    Episode walk = episode.fork();
    walk_along(walk, way_to(walk, node));
    go_on(walk, *best_);
    return worth(walk);
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
    // What the teachers would choose, in their order. The rules' choices are the first two [kOnlineVisits].
    const bool as_near = visits[1].cost <= visits[0].cost * kAboutAsNear;
    const std::size_t choices[] = {0, as_near ? std::size_t{1} : 0, order.front()};
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
    for (std::size_t i = 0; i < teachers_.size(); ++i) {
      const auto place = std::ranges::find(order, choices[i]);
      if (place == order.end()) continue;
      lesson.value[place - order.begin()] += static_cast<float>(kTeacherWeight * teachers_[i].gain);
    }
    lessons.push_back(std::move(lesson));
    return visits[order[rng_.below(static_cast<std::uint32_t>(order.size()))]].node;
  }

  const OnlineLessonOptions& options_;
  const OnlineParameters& parameters_;
  Rng rng_;
  World world_;
  OnlineExplorerPolicy network_policy_;
  RulePolicy pocket_;
  RulePolicy open_;
  std::vector<Teacher> teachers_;  // pocket, open, and the network once it values first visits
  Policy* best_ = nullptr;         // of them
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
