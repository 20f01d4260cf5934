#include "graphdrl/base/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "../support.h"

namespace graphdrl {
namespace {

class ParallelFor : public testing::Test {
 protected:
  ~ParallelFor() override { set_threads(1); }
};

TEST_F(ParallelFor, RunsEveryTaskOnceWithAnyNumberOfThreads) {
  for (const int count : {1, 2, 5, 300}) {
    set_threads(count);
    EXPECT_EQ(threads(), count);
    for (const Schedule schedule : {Schedule::kDynamic, Schedule::kFixed}) {
      for (const int tasks : {0, 1, 2, 100}) {
        std::vector<int> runs(tasks);
        parallel_for(
            tasks, [&](int task) { ++runs[task]; }, schedule);
        EXPECT_EQ(runs, std::vector<int>(tasks, 1));
      }
    }
  }
}

TEST_F(ParallelFor, RunsTasksSideBySide) {
  set_threads(2);
  std::atomic<int> here = 0;
  parallel_for(2, [&](int) {
    ++here;
    while (here != 2) std::this_thread::yield();
  });
  EXPECT_EQ(here, 2);
}

TEST_F(ParallelFor, RunsInOrderOnTheCallersThreadWithinATask) {
  set_threads(3);
  std::vector<std::vector<int>> order(20);
  parallel_for(20, [&](int task) {
    const std::thread::id caller = std::this_thread::get_id();
    for (int repeat = 0; repeat < 2; ++repeat) {
      parallel_for(3, [&](int inner) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        order[task].push_back(inner);
      });
    }
  });
  EXPECT_EQ(order, std::vector<std::vector<int>>(20, {0, 1, 2, 0, 1, 2}));
}

TEST_F(ParallelFor, HandsTheFirstExceptionToTheCallerOnceAllTasksRan) {
  std::atomic<int> done;
  for (const int count : {1, 4}) {
    set_threads(count);
    for (int repeat = 0; repeat < 50; ++repeat) {
      try {
        done = 0;
        parallel_for(100, [&](int task) {
          ++done;
          if (task % 10 == 7) throw std::runtime_error(std::to_string(task));
        });
        FAIL() << "no exception";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "7");
        EXPECT_EQ(done, 100);
      }
    }
  }
}

TEST_F(ParallelFor, GoesOnAfterAnException) {
  set_threads(2);
  EXPECT_THROW(parallel_for(10, [](int) { throw std::runtime_error("any"); }), std::runtime_error);
  std::vector<int> runs(10);
  parallel_for(10, [&](int task) { ++runs[task]; });
  EXPECT_EQ(runs, std::vector<int>(10, 1));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which need memory of their own
TEST_F(ParallelFor, SaysWhereThereAreNoThreads) {
  rlimit before{};
  getrlimit(RLIMIT_DATA, &before);
  rlimit tight = before;
  tight.rlim_cur = 500 << 20;  // 1023 stacks take 4 GB
  set_threads(1024);
  setrlimit(RLIMIT_DATA, &tight);
  const std::string complaint = error_of([] { parallel_for(2, [](int) {}); });
  setrlimit(RLIMIT_DATA, &before);
  EXPECT_NE(complaint.find("cannot make 1024 threads"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("expected a smaller --threads"), std::string::npos) << complaint;
  int runs = 0;  // single-threaded work needs none
  parallel_for(1, [&](int) { ++runs; });
  EXPECT_EQ(runs, 1);
}
#endif

}  // namespace
}  // namespace graphdrl
