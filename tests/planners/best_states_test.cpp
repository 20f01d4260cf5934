#include "graphdrl/planners/best_states.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

Candidate candidate(NodeId node, double spent, Rankings rankings, std::uint64_t hash = 1) {
  return {.parent = 0, .node = node, .spent = spent, .penalties = 0, .rankings = rankings, .visited_hash = hash};
}

TEST(BestStates, KeepTheCheaperOfTwoWaysToAState) {
  BestStates states(10);
  states.add(candidate(1, 5, {5, 5, 5}));
  states.add(candidate(1, 4, {6, 4, 4}));
  states.add(candidate(2, 9, {9, 9, 9}));
  states.add(candidate(1, 9, {1, 9, 9}, /*hash=*/2));
  ASSERT_EQ(states.all().size(), 3u);
  EXPECT_EQ(states.all()[0].spent, 4);
  EXPECT_EQ(states.all()[0].rankings, (Rankings{5, 4, 4})) << "with the better of their first rankings";
}

TEST(BestStates, KeepTheLowerParentsOfTwoEquallyCheapWaysToAState) {
  Candidate one = candidate(1, 5, {5, 5, 5});
  Candidate other = one;
  other.parent = 1;
  for (const bool first : {true, false}) {
    BestStates states(10);
    states.add(first ? one : other);
    states.add(first ? other : one);
    ASSERT_EQ(states.all().size(), 1u);
    EXPECT_EQ(states.all()[0].parent, 0);
  }
}

TEST(BestStates, KeepAThirdByEachRanking) {
  BestStates states(3);
  states.add(candidate(1, 0, {1, 9, 9}));
  states.add(candidate(2, 0, {9, 1, 9}));
  states.add(candidate(3, 0, {9, 9, 1}));
  states.add(candidate(4, 0, {2, 2, 2}));
  EXPECT_TRUE(states.keep_best());
  states.sort(2, 0);
  ASSERT_EQ(states.all().size(), 3u);
  EXPECT_EQ(states.all()[0].node, 3);
}

// What is useless is never kept, whatever else is added.
TEST(BestStates, KeepNothingUseless) {
  Rng rng(4);
  std::size_t left_out = 0;
  for (int round = 0; round < 200; ++round) {
    const std::size_t width = 1 + rng.below(12);
    BestStates all(width);
    BestStates pruned(width);
    // Parents in any order, some of them twice, as in a search that looks around each before it looks farther.
    std::vector<int> parents;
    for (int i = 0; i < 20; ++i) parents.push_back(static_cast<int>(rng.below(20)));
    for (const int parent : parents) {
      pruned.begin_parent(parent);
      for (int i = 0; i < 5; ++i) {
        // Few different values: many ties.
        const auto draw = [&] { return static_cast<double>(rng.below(8)); };
        Candidate one = candidate(static_cast<NodeId>(rng.below(100000)), 0, {draw(), draw(), draw()}, rng.next());
        one.parent = parent;
        all.add(one);
        if (!pruned.is_useless(one.rankings)) pruned.add(one);
      }
    }
    left_out += all.all().size() - pruned.all().size();
    all.keep_best();
    pruned.keep_best();
    all.sort(0, 0);
    pruned.sort(0, 0);
    ASSERT_EQ(all.all().size(), pruned.all().size());
    for (std::size_t i = 0; i < all.all().size(); ++i) EXPECT_EQ(all.all()[i].node, pruned.all()[i].node);
  }
  EXPECT_GT(left_out, 8'000u) << "of 20,000";
}

}  // namespace
}  // namespace graphdrl
