// Loops over independent tasks on one pool of threads, OpenMP's, which OpenBLAS and LibTorch share.
#pragma once

#include <omp.h>

#include <exception>

namespace graphdrl {

// How many threads parallel_for uses from now on; 1 at the start. Call it from the main thread. Everything outside
// parallel_for (LibTorch's own operators, OpenBLAS) runs on the calling thread alone: results then cannot depend on the
// number of threads. REQUIRES: threads >= 1.
void set_threads(int threads);
int threads();
int hardware_threads();

enum class Schedule {
  kDynamic,  // a task goes to the thread that is free
  kFixed,    // task i runs on the same thread every time, whose cache still holds its data
};

// Runs task(0) … task(count - 1), each once, in any order. An exception of a task reaches the caller.
template <typename Task>
void parallel_for(int count, const Task& task, Schedule schedule = Schedule::kDynamic) {
  if (threads() == 1 || count <= 1) {
    for (int i = 0; i < count; ++i) task(i);
    return;
  }
  std::exception_ptr failure;
  const auto run = [&](int i) {
    try {
      task(i);
    } catch (...) {
#pragma omp critical(graphdrl_parallel_for)
      failure = std::current_exception();
    }
  };
  if (schedule == Schedule::kDynamic) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads())
    for (int i = 0; i < count; ++i) run(i);
  } else {
#pragma omp parallel for schedule(static, 1) num_threads(threads())
    for (int i = 0; i < count; ++i) run(i);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace graphdrl
