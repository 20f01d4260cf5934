#include "graphdrl/base/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace graphdrl {
namespace {

TEST(ParallelFor, RunsEveryTaskOnceWithAnyNumberOfThreads) {
  for (const int count : {1, 2, 5}) {
    set_threads(count);
    std::vector<int> runs(100);
    parallel_for(100, [&](int task) { ++runs[task]; });
    EXPECT_EQ(runs, std::vector<int>(100, 1));
  }
  set_threads(1);
}

TEST(ParallelFor, HandsAnExceptionToTheCaller) {
  set_threads(2);
  EXPECT_THROW(parallel_for(10,
                            [](int task) {
                              if (task == 7) throw std::runtime_error("seven");
                            }),
               std::runtime_error);
  set_threads(1);
}

}  // namespace
}  // namespace graphdrl
