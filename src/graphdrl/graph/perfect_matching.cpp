// The only file that sees LEMON, which is no C++20: it is compiled as C++17.
#include "graphdrl/graph/perfect_matching.h"

#include <lemon/full_graph.h>
#include <lemon/matching.h>

#include <stdexcept>

namespace graphdrl {

std::vector<int> cheapest_pairs(const std::vector<std::vector<std::int64_t>>& costs) {
  using lemon::FullGraph;
  const int count = static_cast<int>(costs.size());
  FullGraph pairs(count);
  FullGraph::EdgeMap<std::int64_t> weights(pairs);
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) weights[pairs.edge(pairs(a), pairs(b))] = -costs[a][b];
  }
  lemon::MaxWeightedPerfectMatching<FullGraph, FullGraph::EdgeMap<std::int64_t>> matching(pairs, weights);
  if (!matching.run()) throw std::logic_error("an even number of things has no pairs");
  std::vector<int> mate(costs.size());
  for (int node = 0; node < count; ++node) mate[node] = pairs.id(matching.mate(pairs(node)));
  return mate;
}

}  // namespace graphdrl
