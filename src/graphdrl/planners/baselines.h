// The policies that learn nothing: two random ones, depth first and nearest unvisited.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/env/policy.h"

namespace graphdrl {

// A policy that looks at one episode at a time.
class SingleEpisodePolicy : public Policy {
 public:
  void act(std::span<const Observation> observations, std::span<int> actions) final;

 protected:
  virtual int act_on(const Observation& observation) = 0;
};

// Draws uniformly from all actions: on grids the four directions, blocked or not, as the paper's author's baseline.
class RandomPolicy final : public SingleEpisodePolicy {
 public:
  explicit RandomPolicy(std::uint64_t seed) : rng_(seed) {}

 private:
  int act_on(const Observation& observation) override;
  Rng rng_;
};

// Draws uniformly from the open neighbours.
class RandomWalkPolicy final : public SingleEpisodePolicy {
 public:
  explicit RandomWalkPolicy(std::uint64_t seed) : rng_(seed) {}

 private:
  int act_on(const Observation& observation) override;
  Rng rng_;
};

// Descends to the first unvisited neighbour in the graph's order, and steps back where there is none; in a directed
// graph it walks to the node entered last from which something is left. Stops at the root, and where the budget does
// not last. REQUIRES: it walked the episode from its start. Cost of a move: O(steps walked), in directed graphs O(nodes
// + edges) on top.
class DepthFirstPolicy final : public SingleEpisodePolicy {
  int act_on(const Observation& observation) override;
};

// Walks the cheapest way to the nearest unvisited node, the first one that the search meets. Stops when nothing
// unvisited can be reached or the next step cannot be paid for. Cost of a move: O(nodes + edges), times a logarithm
// where edges have costs.
class NearestUnvisitedPolicy final : public SingleEpisodePolicy {
  int act_on(const Observation& observation) override;
};

}  // namespace graphdrl
