// Loops over independent tasks on one pool of threads, whose waiting threads sleep and leave the processor to others.
#pragma once

#include <functional>

namespace graphdrl {

// How many threads parallel_for uses from now on; 1 at the start. The first loop that needs them makes them. Call it
// from the main thread, outside parallel_for. REQUIRES: threads >= 1.
void set_threads(int threads);
int threads();
// How many processors this process may run on.
int hardware_threads();

enum class Schedule {
  kDynamic,  // a task goes to the thread that is free
  kFixed,    // task i runs on the same thread every time, where possible: its cache still holds the task's data
};

// Runs task(0) … task(count - 1), each once, in any order; within a task of another parallel_for, all on the calling
// thread. The caller gets an exception of a task, that of the lowest i where several throw. Throws MachineError where
// the machine does not give so many threads.
void parallel_for(int count, const std::function<void(int)>& task, Schedule schedule = Schedule::kDynamic);

}  // namespace graphdrl
