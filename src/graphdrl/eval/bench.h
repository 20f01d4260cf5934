// A fixed, seeded workload: how fast episodes are stepped and moves are chosen, and a signature of what happened.
#pragma once

#include <cstdint>

namespace graphdrl {

struct EnvironmentBench {
  double steps_per_s;       // random moves with all seven features kept up to date, resets included; by all threads
  std::uint64_t signature;  // of every episode's last position, visits and reward: the same for any number of threads
};

// On as many threads as parallel_for uses.
EnvironmentBench bench_environment();

// The walks of the planners and policies that learned nothing, as one number: on the paper's maps, and on random worlds
// with and without costs, directions, prizes and ends. The bounds of the latter, too.
std::uint64_t planner_signature();

// Likewise of the explorer, alone and guiding a beam, and of the search, which begins with its walk too. The network
// computes in floats, so another build or processor may give another number.
std::uint64_t learned_signature();

// Median time to choose one move on the paper's map a with a network of random weights, features built from scratch.
double bench_move_ms();

}  // namespace graphdrl
