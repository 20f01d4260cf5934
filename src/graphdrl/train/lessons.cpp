#include "graphdrl/train/lessons.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graphdrl/planners/explorer.h"
#include "graphdrl/train/teacher.h"

namespace graphdrl {
namespace {

// First visits that are labelled: the one that the best walk known makes, the nearest, and others at random
// (docs/explorer.md, "Training").
constexpr std::size_t kFirstLabelled = 4;
constexpr std::size_t kMostLabelled = 6;

// The place of the first visit that the best walk known makes; the first of all where it is not in scope.
std::size_t best_known(const Task& task, std::span<const FirstVisit> visits, Teacher& teacher) {
  const auto found = std::ranges::find(visits, teacher.next_visit(task), &FirstVisit::node);
  return found == visits.end() ? 0 : static_cast<std::size_t>(found - visits.begin());
}

// How far first visits fall short of the ceiling, or kUnlabelled.
std::vector<float> labels(const Task& task, std::span<const FirstVisit> visits, double ceiling, Teacher& teacher,
                          Rng& rng) {
  teacher.look(task);
  std::vector<float> shortfall(visits.size(), kUnlabelled);
  std::vector<std::size_t> order(visits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto best = order.begin() + static_cast<std::ptrdiff_t>(best_known(task, visits, teacher));
  std::rotate(order.begin(), best, best + 1);
  for (std::size_t i = kFirstLabelled; i + 1 < order.size(); ++i) {
    std::swap(order[i], order[i + rng.below(static_cast<std::uint32_t>(order.size() - i))]);
  }
  if (order.size() > kMostLabelled) order.resize(kMostLabelled);
  for (const std::size_t first : order) {
    shortfall[first] = static_cast<float>(ceiling - teacher.value(task, visits[first]));
  }
  return shortfall;
}

}  // namespace

void visit(Lesson& walk, const FirstVisit& first) {
  walk.visited.insert(first.node);
  walk.position = first.node;
  walk.spendable -= first.cost;
}

void LessonBytes::put(const Lesson& lesson, ByteWriter& to) {
  to.put(lesson.at->seed);
  to.put_all<std::uint64_t>(lesson.visited.words());
  to.put(lesson.position);
  to.put(lesson.spendable);
  to.put(lesson.scope);
  to.put_all<float>(lesson.shortfall);
}

Lesson LessonBytes::get(ByteReader& from) {
  const auto seed = from.get<std::uint64_t>();
  if (!at_ || at_->seed != seed) at_ = std::make_shared<LessonWorld>(options_->world_of(seed), seed);
  Lesson lesson{.at = at_,
                .visited = NodeSet(at_->world.node_count()),
                .position = kNoNode,
                .spendable = 0,
                .scope = 0,
                .shortfall = {}};
  std::ranges::copy(from.get_all<std::uint64_t>(), lesson.visited.words().begin());
  lesson.position = from.get<NodeId>();
  lesson.spendable = from.get<double>();
  lesson.scope = from.get<int>();
  lesson.shortfall = from.get_all<float>();
  return lesson;
}

Task rest_of(const Lesson& walk) {
  const double budget = std::max(0.0, walk.spendable);
  return Task(walk.at->world, walk.position, budget).rest(walk.position, budget, walk.visited);
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
  const auto between = [&](double least, double most) { return least + (most - least) * rng.uniform(); };
  const double ratio = chance(options.ample) ? between(options.most_budget, options.most_ample_budget)
                                             : between(options.least_budget, options.most_budget);
  Lesson walk{.at = at,
              .visited = NodeSet(world.node_count()),
              .position = start,
              .spendable = world.spending_limit(ratio * world.valid_count() * world.open().mean_cost()),
              .scope = kExplorerScope,
              .shortfall = {}};
  visit(walk, {start, 0});
  if (chance(options.small_scope)) {
    walk.scope = options.least_scope +
                 static_cast<int>(rng.below(static_cast<std::uint32_t>(kExplorerScope - options.least_scope)));
  }
  const bool by_network = chance(options.lead);
  const double share = static_cast<double>(options.states_per_walk) / (std::min(ratio, 1.0) * world.valid_count());
  Teacher teacher(options.teacher_steps, rng.next());
  teacher.begin(rest_of(walk));

  std::vector<Lesson> lessons;
  ExplorerBatch batch;
  ExplorerScratch scratch;
  std::vector<float> shortfall;
  for (;;) {
    batch.clear();
    const auto visits = walk.append_to(batch, scratch);
    if (visits.empty()) return lessons;
    if (chance(share) && visits.size() > 1) {
      lessons.push_back(walk);
      lessons.back().shortfall = labels(rest_of(walk), visits, batch.ceiling[0], teacher, rng);
    }
    std::size_t choice = 0;
    if (chance(options.explore)) {
      choice = rng.below(static_cast<std::uint32_t>(visits.size()));
    } else if (by_network) {
      scorer.shortfalls(batch, shortfall);
      choice = static_cast<std::size_t>(std::ranges::min_element(shortfall) - shortfall.begin());
    } else {
      choice = best_known(rest_of(walk), visits, teacher);
    }
    teacher.visited(visits[choice].node);
    visit(walk, visits[choice]);
  }
}

}  // namespace graphdrl
