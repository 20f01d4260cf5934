// Loops over independent tasks on one pool of threads, whose waiting threads sleep and leave the processor to others.
#pragma once

namespace graphdrl {

// How many threads parallel_for uses from now on; 1 at the start. Call it from the main thread, outside parallel_for.
// REQUIRES: threads >= 1.
void set_threads(int threads);
int threads();
// How many processors this process may run on.
int hardware_threads();

enum class Schedule {
  kDynamic,  // a task goes to the thread that is free
  kFixed,    // task i runs on the same thread every time, where possible: its cache still holds the task's data
};

namespace detail {

// Whether the caller is a task of parallel_for.
bool in_task();
// Calls run(task, 0) … run(task, count - 1) on threads() threads.
void run_on_pool(int count, void (*run)(const void* task, int i), const void* task, Schedule schedule);

}  // namespace detail

// Runs task(0) … task(count - 1), each once, in any order; within a task of another parallel_for, all on the calling
// thread. The caller gets an exception of a task, that of the lowest i where several throw.
template <typename Task>
void parallel_for(int count, const Task& task, Schedule schedule = Schedule::kDynamic) {
  if (threads() == 1 || count <= 1 || detail::in_task()) {
    for (int i = 0; i < count; ++i) task(i);
    return;
  }
  detail::run_on_pool(
      count, [](const void* erased, int i) { (*static_cast<const Task*>(erased))(i); }, &task, schedule);
}

}  // namespace graphdrl
