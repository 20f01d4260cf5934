// What the online explorer learns from: states met on walks through unknown maps, and what first visits brought in the
// end, where a policy went on from each of them.
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/base/bytes.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/nn/online_network.h"

namespace graphdrl {

struct OnlineLessonOptions {
  std::vector<WorldSpec> worlds;  // drawn from with equal chances
  double lead = 0;                // chance of a walk to be led by the network, else by the best teacher
  bool by_rules = false;          // the rules pocket and open are the teachers; else the network is one, too
  double least_budget = 0.4;      // times valid nodes and mean cost
  double most_budget = 1.3;
  double unlimited = 0.15;  // chance of no budget: then what it costs to visit all counts
  double home = 0.15;       // chance of a walk to end where it starts
  int states_per_walk = 6;
  double explore = 0.15;  // chance of a random first visit at such a state
  int most_valued = 8;    // first visits of a state
};

// One state: its first visits that were valued.
struct OnlineLesson {
  std::vector<float> rows;   // [C, features]
  std::vector<float> value;  // [C], % of the nodes, less the mean; what teachers would choose is worth more
};

// Lessons as other ranks tell them.
struct OnlineLessonBytes {
  static void put(const OnlineLesson& lesson, ByteWriter& to) {
    to.put_all<float>(lesson.rows);
    to.put_all<float>(lesson.value);
  }
  static OnlineLesson get(ByteReader& from) {
    auto rows = from.get_all<float>();
    return {.rows = std::move(rows), .value = from.get_all<float>()};
  }
};

// The lessons of one random walk. The same for the same seed.
std::vector<OnlineLesson> draw_online_lessons(const OnlineLessonOptions& options, const OnlineParameters& parameters,
                                              std::uint64_t seed);

}  // namespace graphdrl
