#include "graphdrl/train/lessons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/explorer.h"

namespace graphdrl {
namespace {

// First visits that are labelled: the nearest, and others at random (docs/explorer.md, "Training").
constexpr std::size_t kNearestLabelled = 3;
constexpr std::size_t kMostLabelled = 6;
constexpr int kTeacherBranching = 8;  // twice as many cost twice as much and value hardly better

// Columns of ExplorerBatch::visit_x, and what undoes their scale [explorer_features.h].
constexpr int kVisitCost = 0;
constexpr int kChangeOfPenalties = 1;
constexpr float kCostScale = 8;
constexpr float kPenaltyScale = 4;

// How many nodes a beam visits from here.
int gain_by_search(const Lesson& walk, int width) {
  const Task task = rest_of(walk);
  const Plan plan = beam_plan(task, {.width = width, .branching = kTeacherBranching, .cut_ties = true});
  return plan.visited - task.visited.count();
}

// The start of a random walk with `ratio` mean edges to spend for each valid node.
Lesson begin_walk(const std::shared_ptr<LessonWorld>& at, NodeId start, double ratio) {
  const World& world = at->world;
  Lesson walk{.at = at,
              .visited = NodeSet(world.node_count()),
              .position = start,
              .spendable = world.spending_limit(ratio * world.valid_count() * world.open().mean_cost()),
              .scope = kExplorerScope,
              .choice = 0,
              .shortfall = {}};
  visit(walk, {start, 0});
  return walk;
}

// What the first visits of a state are worth by search, or kUnlabelled.
std::vector<float> search_labels(const Lesson& walk, std::span<const FirstVisit> visits, double ceiling, int width,
                                 Rng& rng) {
  std::vector<float> shortfall(visits.size(), kUnlabelled);
  std::vector<std::size_t> order(visits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = kNearestLabelled; i + 1 < order.size(); ++i) {
    std::swap(order[i], order[i + rng.below(static_cast<std::uint32_t>(order.size() - i))]);
  }
  if (order.size() > kMostLabelled) order.resize(kMostLabelled);
  for (const std::size_t first : order) {
    Lesson after = walk;
    visit(after, visits[first]);
    const int gain = 1 + gain_by_search(after, width);
    shortfall[first] = static_cast<float>(ceiling - gain);
  }
  return shortfall;
}

// The first visit of least cost and change of penalties, as a beam ranks them.
std::size_t best_by_rank(const ExplorerBatch& batch, std::size_t count) {
  const auto rank = [&](std::size_t first) {
    const float* const row = batch.visit_x.data() + first * kExplorerVisitFeatureCount;
    return kCostScale * row[kVisitCost] + kPenaltyScale * row[kChangeOfPenalties];
  };
  std::size_t best = 0;
  for (std::size_t first = 1; first < count; ++first) {
    if (rank(first) < rank(best)) best = first;
  }
  return best;
}

// The least of all that are labelled. REQUIRES: the first of all is.
std::size_t least_of(std::span<const float> shortfall) {
  std::size_t least = 0;
  for (std::size_t first = 0; first < shortfall.size(); ++first) {
    if (shortfall[first] < shortfall[least]) least = first;
  }
  return least;
}

}  // namespace

void visit(Lesson& walk, const FirstVisit& first) {
  walk.visited.insert(first.node);
  walk.position = first.node;
  walk.spendable -= first.cost;
}

Task rest_of(const Lesson& walk) {
  return {
      .view = walk.at->world, .start = walk.position, .budget = std::max(0.0, walk.spendable), .visited = walk.visited};
}

LessonWorld::LessonWorld(const WorldSpec& spec, std::uint64_t of_seed)
    : seed(of_seed), rng(of_seed), world(random_world(spec, rng)) {}

std::vector<Lesson> draw_lessons(const LessonOptions& options, const ExplorerParameters& parameters,
                                 std::uint64_t seed) {
  const auto at = std::make_shared<LessonWorld>(options.world_of(seed), seed);
  const World& world = at->world;
  Rng rng = at->rng;
  const auto chance = [&](double p) { return rng.uniform() < p; };
  // No ownership: the parameters stay the caller's.
  ExplorerScorer scorer(SharedExplorer(std::shared_ptr<void>(), &parameters));
  const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
  const double ratio = options.least_budget + (options.most_budget - options.least_budget) * rng.uniform();
  Lesson walk = begin_walk(at, start, ratio);
  if (chance(options.small_scope)) {
    walk.scope = options.least_scope +
                 static_cast<int>(rng.below(static_cast<std::uint32_t>(kExplorerScope - options.least_scope)));
  }
  const bool by_network = chance(options.lead);
  const double share = static_cast<double>(options.states_per_walk) / (std::min(ratio, 1.0) * world.valid_count());

  std::vector<Lesson> lessons;
  ExplorerBatch batch;
  std::vector<float> shortfall;
  for (;;) {
    batch.clear();
    const auto visits = walk.append_to(batch, scorer.encoder());
    if (visits.empty()) return lessons;
    Lesson lesson = walk;
    const bool kept = chance(share) && (visits.size() > 1 || options.teacher_width == 0);
    const bool taught = kept && options.teacher_width > 0;
    if (taught) lesson.shortfall = search_labels(walk, visits, batch.ceiling[0], options.teacher_width, rng);
    std::size_t choice = 0;
    if (chance(options.explore)) {
      choice = rng.below(static_cast<std::uint32_t>(visits.size()));
    } else if (by_network) {
      scorer.shortfalls(batch, shortfall);
      choice = least_of(shortfall);
    } else {
      choice = taught ? least_of(lesson.shortfall) : best_by_rank(batch, visits.size());
    }
    lesson.choice = static_cast<int>(choice);
    if (kept) lessons.push_back(std::move(lesson));
    visit(walk, visits[choice]);
  }
}

}  // namespace graphdrl
