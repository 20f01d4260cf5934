// What the explorer learns from: states met on the way through random worlds, with what first visits are worth by
// search.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "graphdrl/base/bytes.h"
#include "graphdrl/env/task.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/nn/explorer_network.h"

namespace graphdrl {

// The defaults are what the explorer in the program was trained with; only `lead` was varied (docs/explorer.md).
struct LessonOptions {
  std::vector<WorldSpec> worlds;  // drawn from with equal chances
  int teacher_steps = 2;          // of the search for one label [teacher.h]
  double lead = 0;                // chance of a walk to be led by the network's least shortfall, else by search
  double least_budget = 0.5;      // times valid nodes and mean cost
  double most_budget = 1.5;
  double ample = 0.15;  // chance of a budget that is larger still,
  double most_ample_budget = 3;
  double small_scope = 0.35;  // chance of a walk to be seen through a smaller scope than the explorer's,
  int least_scope = 24;       // at least this
  int states_per_walk = 6;    // asked for of each walk; about four teach something: others have a single first visit
  double explore = 0.15;      // chance of a random first visit on the way

  const WorldSpec& world_of(std::uint64_t seed) const { return worlds[seed % worlds.size()]; }
};

inline constexpr float kUnlabelled = std::numeric_limits<float>::quiet_NaN();

// The world of a lesson, drawn again from its seed at any time.
struct LessonWorld {
  LessonWorld(const WorldSpec& spec, std::uint64_t seed);

  std::uint64_t seed;
  Rng rng;  // as the world left it: draws the walk
  World world;
};

// One state and what its first visits are worth. Small: features are built when it is used.
struct Lesson {
  std::shared_ptr<const LessonWorld> at;
  NodeSet visited;
  NodeId position;
  double spendable;
  int scope;                     // nodes the network looks at
  std::vector<float> shortfall;  // by first visit; kUnlabelled for some where there are many

  // Appends the state; gives its first visits, until the scratch memory is used again.
  std::span<const FirstVisit> append_to(ExplorerBatch& batch, ExplorerScratch& scratch) const {
    const Task task(at->world, position, std::max(0.0, spendable));
    return encode(Exploration(task, visited, visited.count(), position, spendable), scratch, batch, scope).visits;
  }
};

// Lessons as other ranks tell them, one walk after the other: their worlds are drawn again.
class LessonBytes {
 public:
  explicit LessonBytes(const LessonOptions& options) : options_(&options) {}
  static void put(const Lesson& lesson, ByteWriter& to);
  Lesson get(ByteReader& from);

 private:
  const LessonOptions* options_;
  std::shared_ptr<const LessonWorld> at_;  // the last lesson's
};

// What is left to do of the walk.
Task rest_of(const Lesson& walk);

// Goes on with a first visit.
void visit(Lesson& walk, const FirstVisit& first);

// The lessons of one random walk, which the network of these parameters may lead. The same for the same seed.
std::vector<Lesson> draw_lessons(const LessonOptions& options, const ExplorerParameters& parameters,
                                 std::uint64_t seed);

}  // namespace graphdrl
