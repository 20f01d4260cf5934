#include "graphdrl/env/task.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// 0 - 1 - 2 - 3 - 4, edges of cost 2.
World path(GivenTask given = {}) {
  const std::vector<Edge> edges = {{0, 1, 2}, {1, 2, 2}, {2, 3, 2}, {3, 4, 2}};
  return World("path", Graph::from_edges(5, edges), std::vector<bool>(5), {}, {}, given);
}

TEST(Task, IsWhatWasAskedElseTheMapsOwnElseTheDefault) {
  const Task own(path({.budget = 9, .start = 1, .end = 2}), Asked());
  EXPECT_EQ(own.budget(), 9);
  EXPECT_EQ(own.start(), 1);
  EXPECT_EQ(own.end(), 2);
  const Task asked(path({.budget = 9, .start = 1, .end = 2}),
                   {.budget = Budget(8), .start = 3, .end = End::anywhere()});
  EXPECT_EQ(asked.budget(), 8);
  EXPECT_EQ(asked.start(), 3);
  EXPECT_TRUE(asked.ends_anywhere());
  const Task plain(path(), {.budget = Budget::parse("1x"), .end = End::at_start()});
  EXPECT_EQ(plain.budget(), 10);
  EXPECT_EQ(plain.start(), 0);
  EXPECT_EQ(plain.end(), 0);
  EXPECT_THAT(error_of([] { Task(path(), Asked()); }), HasSubstr("no budget is given"));
}

TEST(Task, IsCheckedWhenItIsMade) {
  EXPECT_THAT(error_of([] { Task(path(), 0, -1); }), HasSubstr("bad budget"));
  EXPECT_THAT(error_of([] { Task(path(), 5, 1); }), HasSubstr("start outside"));
  EXPECT_THAT(error_of([] { Task(path(), 0, 9, End::at(9)); }), HasSubstr("end outside"));
  EXPECT_THAT(error_of([] { Task(path(), 0, 7, End::at(4)); }), HasSubstr("cannot be reached within the budget"));
  Task task(path(), 4, 7, End::at(4));
  EXPECT_THAT(error_of([&] { task.start_at(0); }), HasSubstr("cannot be reached"));
  EXPECT_EQ(task.start(), 4) << "as before";
  task.start_at(1);
  EXPECT_EQ(task.start(), 1);
  EXPECT_EQ(task.end(), 4);
}

TEST(Task, KnowsItsCostToTheEndAndWhatIsInReach) {
  Task task(path(), 1, 6, End::at_start());
  EXPECT_EQ(task.cost_to_end(4), 6);
  EXPECT_THAT(task.reach().nodes, ElementsAre(1, 0, 2));
  task.start_at(4);  // the end moves with it
  EXPECT_EQ(task.end(), 4);
  EXPECT_EQ(task.cost_to_end(4), 0);
  EXPECT_THAT(task.reach().nodes, ElementsAre(4, 3));
}

TEST(Task, TellsGroundFromWhatIsClaimed) {
  const Task whole(path(), 0, 8, End::at_start());
  EXPECT_EQ(whole.prize(0), 1);
  EXPECT_FALSE(whole.has_prizes());
  NodeSet others(5);
  others.insert(1);
  const Task shared = whole.without(others);
  EXPECT_EQ(shared.prize(1), 0);
  EXPECT_FALSE(shared.ground().contains(1));
  EXPECT_TRUE(shared.has_prizes());
  NodeSet visited(5);
  visited.insert(0);
  const Task rest = shared.rest(1, 4, visited);
  EXPECT_EQ(rest.start(), 1);
  EXPECT_EQ(rest.end(), 0) << "where the whole walk must end";
  EXPECT_EQ(rest.ground_count(), 2);
  EXPECT_TRUE(rest.ground().contains(1));
  EXPECT_EQ(rest.prize(0), 0);
  EXPECT_EQ(rest.prize(2), 1);
}

}  // namespace
}  // namespace graphdrl
