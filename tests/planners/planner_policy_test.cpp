#include "graphdrl/planners/planner_policy.h"

#include <gmock/gmock.h>

#include "graphdrl/env/episode.h"
#include "graphdrl/planners/exact.h"
#include "support.h"

namespace graphdrl {
namespace {

// A path whose nodes are seen one after the other.
class Path {
 public:
  explicit Path(int nodes) {
    for (int node = 0; node < nodes; ++node) grow();
  }
  void grow() {
    known_.begin_visit();
    const NodeId node = known_.see();
    if (node > 0) known_.connect({node - 1, node});
    if (node > 0) known_.close(node - 1);
  }
  const View& view() const { return known_.view(); }

 private:
  Discovery known_ = Discovery("path", EdgeKind::kUndirected);
};

class CountingPlanner final : public Planner {
 public:
  explicit CountingPlanner(int& plans, int& from) : plans_(&plans), from_(&from) {}
  Plan plan(const Task& task, const Clock& clock) override {
    ++*plans_;
    return exact_.plan(task, clock);
  }
  Plan plan_from(const Task& task, Plan known, const Clock& clock) override {
    ++*from_;
    return Planner::plan_from(task, std::move(known), clock);
  }

 private:
  ExactPlanner exact_;
  int* plans_;
  int* from_;
};

// An observation at the end of a walk.
struct Seen {
  Seen(const View& view, std::vector<NodeId> nodes, double budget)
      : task(view, nodes.front(), budget),
        walk(std::move(nodes)),
        visits(view.node_count()),
        ground(view.node_count()) {
    now = {.task = &task,
           .action_space = ActionSpace::kNeighbours,
           .position = walk.back(),
           .visits = visits,
           .ground_nodes = &ground,
           .walk = walk,
           .walk_hash = kEmptyWalkHash,
           .visited_count = 0,
           .spent = static_cast<double>(walk.size()) - 1,
           .spendable = budget - (static_cast<double>(walk.size()) - 1)};
    for (const NodeId node : walk) {
      ++visits[node];
      ground.insert(node);
      now.walk_hash = extended_walk_hash(now.walk_hash, node);
    }
  }
  Task task;
  std::vector<NodeId> walk;
  std::vector<std::uint32_t> visits;
  NodeSet ground;
  Observation now;
};

int chosen(PlannerPolicy& policy, const Seen& seen) {
  int action = kStop;
  policy.act({&seen.now, 1}, {&action, 1});
  return action == kStop ? kNoNode : seen.now.target(action);
}

TEST(PlannerPolicy, PlansAnewOnceMoreIsKnown) {
  int plans = 0;
  int from = 0;
  PlannerPolicy policy(std::make_unique<CountingPlanner>(plans, from));
  Path path(3);
  const View view = path.view();
  const Seen start(view, {0}, 6);
  EXPECT_EQ(chosen(policy, start), 1);
  EXPECT_EQ(chosen(policy, Seen(view, {0, 1}, 6)), 2) << "as planned";
  EXPECT_EQ(plans, 1);
  EXPECT_TRUE(view.is_frontier(2));
  EXPECT_EQ(chosen(policy, Seen(view, {0, 1, 2}, 6)), kNoNode) << "nothing else is known";
  // The same world, in which a fourth node has turned up.
  path.grow();
  EXPECT_EQ(chosen(policy, Seen(view, {0, 1, 2}, 6)), 3);
  EXPECT_EQ(plans, 2);
  EXPECT_EQ(from, 1) << "it goes on from the last plan";
  EXPECT_EQ(chosen(policy, Seen(view, {0, 1, 2, 3}, 6)), kNoNode);
  EXPECT_EQ(plans, 2);
}

TEST(PlannerPolicy, PlansAnewOnceOthersClaimNodes) {
  int plans = 0;
  int from = 0;
  PlannerPolicy policy(std::make_unique<CountingPlanner>(plans, from));
  const Path path(5);
  Seen middle(path.view(), {2}, 2);
  EXPECT_EQ(chosen(policy, middle), 1);
  NodeSet claimed(5);
  claimed.insert(0);
  claimed.insert(1);
  middle.task = middle.task.without(claimed);
  EXPECT_EQ(chosen(policy, middle), 3) << "where something is left";
  EXPECT_EQ(chosen(policy, middle), 3);
  EXPECT_EQ(plans, 2);
  EXPECT_EQ(from, 1) << "it goes on from the last plan";
}

TEST(PlannerPolicy, TakesNoPlanOfAnotherWorld) {
  int plans = 0;
  int from = 0;
  PlannerPolicy policy(std::make_unique<CountingPlanner>(plans, from));
  EXPECT_EQ(chosen(policy, Seen(Path(3).view(), {0}, 6)), 1);
  EXPECT_EQ(chosen(policy, Seen(Path(4).view(), {0}, 6)), 1);
  EXPECT_EQ(plans, 2);
  EXPECT_EQ(from, 0);
}

}  // namespace
}  // namespace graphdrl
