#include "graphdrl/planners/visited_sets.h"

#include <gtest/gtest.h>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

// Against whole sets, copied walk by walk: levels of all widths, walks that agree again after a while, nodes that come
// to be visited by all.
TEST(VisitedSets, AreWholeSets) {
  constexpr NodeId kNodes = 300;
  Rng rng(1);
  for (int round = 0; round < 20; ++round) {
    NodeSet start(kNodes);
    start.insert(7);
    VisitedSets sets(start, kNodes);
    std::vector<NodeSet> twins = {start};
    for (int level = 0; level < 120; ++level) {
      const auto width = 1 + rng.below(round % 5 == 0 ? 3 : 40);
      std::vector<Candidate> children;
      std::vector<NodeSet> next;
      for (std::uint32_t i = 0; i < width; ++i) {
        const int parent = static_cast<int>(rng.below(static_cast<std::uint32_t>(twins.size())));
        NodeId node = static_cast<NodeId>(rng.below(kNodes));
        while (twins[parent].contains(node)) node = (node + 1) % kNodes;
        children.push_back({.parent = parent, .node = node});
        next.push_back(twins[parent]);
        next.back().insert(node);
      }
      sets.advance(children);
      twins = next;
      for (std::size_t walk = 0; walk < twins.size(); ++walk) {
        for (NodeId node = 0; node < kNodes; ++node) {
          ASSERT_EQ(sets[static_cast<int>(walk)].contains(node), twins[walk].contains(node)) << level << " " << node;
        }
      }
    }
  }
}

// Rows become shorter when walks agree again: what was wider must not be copied over its neighbours.
TEST(VisitedSets, ShrinkWhenWalksAgree) {
  constexpr NodeId kNodes = 2000;
  constexpr int kWidth = 8;
  VisitedSets sets(NodeSet(kNodes), kNodes);
  std::vector<NodeSet> twins = {NodeSet(kNodes)};
  for (NodeId level = 0; level < 120; ++level) {
    std::vector<Candidate> children;
    std::vector<NodeSet> next;
    for (int walk = 0; walk < kWidth; ++walk) {
      // Each on its own, until all go on from one of them.
      const bool together = level % 40 == 0;
      const int parent = together || twins.size() == 1 ? 0 : walk;
      const NodeId node = level * kWidth + walk;
      children.push_back({.parent = parent, .node = node});
      next.push_back(twins[parent]);
      next.back().insert(node);
    }
    sets.advance(children);
    twins = next;
    for (int walk = 0; walk < kWidth; ++walk) {
      for (NodeId node = 0; node < kNodes; ++node) {
        ASSERT_EQ(sets[walk].contains(node), twins[walk].contains(node)) << level << " " << node;
      }
    }
  }
}

}  // namespace
}  // namespace graphdrl
