#include "graphdrl/io/task_folder.h"

#include <gmock/gmock.h>

#include <atomic>
#include <nlohmann/json.hpp>

#include "graphdrl/base/note.h"
#include "graphdrl/io/file.h"
#include "ranks_support.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

TEST(TaskShare, IsParsed) {
  const TaskShare share = parse_task_share("3/20");
  EXPECT_EQ(share.index, 2);
  EXPECT_EQ(share.count, 20);
  EXPECT_TRUE(share.has(22));
  EXPECT_FALSE(share.has(3));
  for (const char* const bad : {"", "3", "0/2", "3/2", "-1/2", "1/0", "1/2/3", "1/2 ", "a/b", "1/9999999"}) {
    EXPECT_THAT(error_of([&] { parse_task_share(bad); }), HasSubstr("--task")) << bad;
  }
}

bool never() {
  return false;
}

TEST(TaskFolder, LeavesOutWhatFailedThreeTimes) {
  const TemporaryFolder temporary;
  const TaskFolder folder(temporary / "tasks");
  const std::vector<TaskFolder::Task> tasks = {{"a", false}, {"sub/b", false}, {"c", true}, {"d", false}};
  std::vector<std::string> notes;
  listen_to_notes([&](const std::string& note) { notes.push_back(note); });
  for (int time = 1; time <= 4; ++time) {
    std::vector<int> done;
    const std::string error = error_of([&] {
      EXPECT_TRUE(folder.run(tasks, {}, never, [&](int task) {
        if (task == 1) throw Error({.what = "bad luck"});
        done.push_back(task);
        return true;
      }));
    });
    EXPECT_EQ(error, time < 4 ? "bad luck" : "");
    EXPECT_THAT(done, ElementsAre(0, 3));
    EXPECT_EQ(folder.is_left_out("sub/b"), time >= 3);
  }
  listen_to_notes({});
  EXPECT_THAT(notes,
              ElementsAre("sub/b failed, 1 of 3 times: bad luck", "sub/b failed, 2 of 3 times: bad luck",
                          "sub/b failed, 3 of 3 times: bad luck", HasSubstr("sub/b failed 3 times and is left")));
}

TEST(TaskFolder, ForgetsAFailureThatIsOver) {
  const TemporaryFolder temporary;
  const TaskFolder folder(temporary / "tasks");
  EXPECT_NE(error_of([&] {
              folder.run({{"a", false}}, {}, never, [](int) -> bool { throw Error({.what = "no"}); });
            }),
            "");
  EXPECT_EQ(folder.failure_of("a")->times, 1);
  EXPECT_TRUE(folder.run({{"a", false}}, {}, never, [](int) { return true; }));
  EXPECT_FALSE(folder.failure_of("a"));
}

TEST(TaskFolder, EndsWithTheMachineAndBlamesNoTask) {
  const TemporaryFolder temporary;
  const TaskFolder folder(temporary / "tasks");
  int asked = 0;
  EXPECT_THROW(folder.run({{"a", false}, {"b", false}}, {}, never,
                          [&](int) -> bool {
                            ++asked;
                            throw MachineError({.what = "full"});
                          }),
               MachineError);
  EXPECT_EQ(asked, 1);
  EXPECT_FALSE(folder.failure_of("a"));
}

TEST(TaskFolder, StopsWhenToldTo) {
  const TemporaryFolder temporary;
  int asked = 0;
  EXPECT_FALSE(TaskFolder(temporary / "tasks")
                   .run(
                       {{"a", false}, {"b", false}}, {}, [&] { return asked == 1; },
                       [&](int) {
                         ++asked;
                         return true;
                       }));
  EXPECT_EQ(asked, 1);
}

TEST(ResultsThread, AreTheSameAloneOnRanksAndInShares) {
  const TemporaryFolder temporary;
  const std::vector<std::string> names = {"a", "b", "c", "d", "e"};
  std::atomic<int> computed = 0;
  const auto compute = [&](int task) {
    ++computed;
    return Json({{"third", (task + 1) / 3.0}});
  };
  const auto alone = results_of(names, nullptr, {}, compute);
  ASSERT_TRUE(alone);
  EXPECT_EQ((*alone)[1]["third"], 2 / 3.0);
  const TaskFolder folder(temporary / "kept");
  std::atomic<int> equal = 0;
  on_ranks(3, [&](Ranks& ranks) {
    equal += results_of(names, nullptr, {.ranks = ranks}, compute) == alone;
    equal += results_of(names, &folder, {.ranks = ranks}, compute) == alone;
  });
  EXPECT_EQ(equal, 6);
  EXPECT_EQ(computed, 15);
  EXPECT_EQ(results_of(names, &folder, {}, compute), alone);
  EXPECT_EQ(computed, 15);  // all were kept
  const TaskFolder shared(temporary / "shared");
  EXPECT_FALSE(results_of(names, &shared, {.share = {.index = 0, .count = 2}}, compute));
  EXPECT_FALSE(results_of(names, &shared, {.share = TaskShare::none()}, compute));
  EXPECT_EQ(computed, 18);
  EXPECT_EQ(results_of(names, &shared, {.share = {.index = 1, .count = 2}}, compute), alone);
}

}  // namespace
}  // namespace graphdrl
