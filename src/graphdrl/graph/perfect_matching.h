// Pairs of things that cost least.
#pragma once

#include <cstdint>
#include <vector>

namespace graphdrl {

// The partner of each of an even number of things, so that all pairs together cost least [Edmonds 1965]. costs: [N][N],
// between any two, the same both ways. Cost: O(N³ log N).
std::vector<int> cheapest_pairs(const std::vector<std::vector<std::int64_t>>& costs);

}  // namespace graphdrl
