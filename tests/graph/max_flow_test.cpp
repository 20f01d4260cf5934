#include "graphdrl/graph/max_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

TEST(MaxFlow, IsWorkedOutByHand) {
  // 0 → 1 → 3 and 0 → 2 → 3, with a way across; 4 hangs from 3.
  MaxFlow network(5);
  network.add_arc(0, 1, 3);
  network.add_arc(0, 2, 2);
  const int across = network.add_arc(1, 2, 1);
  network.add_arc(1, 3, 1.5);
  network.add_arc(2, 3, 4);
  network.add_arc(3, 4, 1, 1);
  EXPECT_TRUE(network.reaches(0, 3, 4.5));
  EXPECT_FALSE(network.reaches(0, 3, 4.6)) << "1 → 2 and 1 → 3 bring 2.5, 0 → 2 brings 2";
  EXPECT_EQ(network.near_side(), (std::vector<int>{0, 1}));
  EXPECT_TRUE(network.reaches(4, 3, 1)) << "the capacity the other way";
  EXPECT_FALSE(network.reaches(3, 0, 0.1));
  network.set_capacity(across, 2);
  EXPECT_TRUE(network.reaches(0, 3, 5));
  EXPECT_FALSE(network.reaches(0, 3, 5.1));
}

// The least cut is found by looking at all.
TEST(MaxFlow, IsTheMinimumCut) {
  Rng rng(1);
  for (int round = 0; round < 300; ++round) {
    const int nodes = 2 + static_cast<int>(rng.below(6));
    MaxFlow network(nodes);
    struct Arc {
      int from;
      int to;
      double capacity;
      double back;
    };
    std::vector<Arc> arcs;
    for (int i = 0; i < 2 * nodes; ++i) {
      const auto node = [&] { return static_cast<int>(rng.below(static_cast<std::uint32_t>(nodes))); };
      const Arc arc{node(), node(), 0.5 * rng.below(5), 0.5 * rng.below(3)};
      if (arc.from == arc.to) continue;
      arcs.push_back(arc);
      network.add_arc(arc.from, arc.to, arc.capacity, arc.back);
    }
    const auto cut = [&](unsigned side) {
      double sum = 0;
      for (const Arc& arc : arcs) {
        const bool from = (side >> arc.from & 1U) != 0;
        const bool to = (side >> arc.to & 1U) != 0;
        if (from && !to) sum += arc.capacity;
        if (to && !from) sum += arc.back;
      }
      return sum;
    };
    double least = std::numeric_limits<double>::infinity();
    for (unsigned side = 0; side < 1U << nodes; ++side) {
      if ((side & 1U) != 0 && (side & 2U) == 0) least = std::min(least, cut(side));
    }
    ASSERT_TRUE(network.reaches(0, 1, least));
    ASSERT_FALSE(network.reaches(0, 1, least + 0.25));
    unsigned side = 0;
    for (const int node : network.near_side()) side |= 1U << node;
    ASSERT_EQ(cut(side), least);
  }
}

}  // namespace
}  // namespace graphdrl
