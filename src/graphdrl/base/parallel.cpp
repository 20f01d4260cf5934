#include "graphdrl/base/parallel.h"

#include <pthread.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <latch>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "graphdrl/base/error.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace graphdrl {
namespace {

// oneTBB keeps its threads, by default, to one per processor: the limit makes way for more, the arena asks for them.
struct Pool {
  explicit Pool(int threads) : limit(tbb::global_control::max_allowed_parallelism, threads), arena(threads) {}

  tbb::global_control limit;
  tbb::task_arena arena;
};

int thread_count = 1;
std::mutex pool_mutex;
std::optional<Pool> pool;  // made by the first loop that needs it
thread_local bool within_task = false;

// Starts so many threads at once, with stacks as large as oneTBB's, and ends them. Throws MachineError where one of
// them cannot be made: oneTBB would end the program there.
void prove_threads(int count) {
  std::latch all_started(1);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, tbb::global_control::active_value(tbb::global_control::thread_stack_size));
  const auto wait = [](void* latch) -> void* {
    static_cast<std::latch*>(latch)->wait();
    return nullptr;
  };
  std::vector<pthread_t> started;
  started.reserve(count);
  int error = 0;
  while (error == 0 && std::ssize(started) < count) {
    pthread_t thread;
    error = pthread_create(&thread, &attributes, wait, &all_started);
    if (error == 0) started.push_back(thread);
  }
  all_started.count_down();
  for (const pthread_t thread : started) pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  if (error == 0) return;
  throw MachineError(
      {.what = "cannot make " + std::to_string(count + 1) + " threads (" + std::generic_category().message(error) + ")",
       .expected = "a smaller --threads, or more memory"});
}

Pool& ready_pool() {
  const std::lock_guard lock(pool_mutex);
  if (!pool) {
    prove_threads(thread_count - 1);
    pool.emplace(thread_count);
  }
  return *pool;
}

// ThreadSanitizer does not see how libtbb.so orders a loop's begin before its tasks and these before its end. These say
// it: what comes before release(mark) comes before what follows acquire(mark).
#ifdef __SANITIZE_THREAD__
void release(void* mark) {
  __tsan_release(mark);
}
void acquire(void* mark) {
  __tsan_acquire(mark);
}
#else
void release(void*) {}
void acquire(void*) {}
#endif

// One call of parallel_for.
class Loop {
 public:
  explicit Loop(const std::function<void(int)>& task) : task_(task) { release(&begin_); }

  void run(int i) {
    acquire(&begin_);
    within_task = true;
    try {
      task_(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_ || i < failed_) {
        failure_ = std::current_exception();
        failed_ = i;
      }
    }
    within_task = false;
    release(&end_);
  }

  // After the last task.
  void finish() {
    acquire(&end_);
    // oneTBB counts the tasks left in a word of the caller's stack, within 4 KB below this loop. The thread that ends
    // the last task writes it. ThreadSanitizer must see that the caller waited for that, as it uses its stack again.
    for (int below = 0; below < 4096; below += 8) acquire(reinterpret_cast<char*>(this) - below);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const std::function<void(int)>& task_;
  // Each order has a mark of its own: with one for both, the end of a task would order the next one behind it and hide
  // their races.
  char begin_ = 0;
  char end_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
  int failed_ = 0;
};

}  // namespace

void set_threads(int threads) {
  thread_count = threads;
  pool.reset();
}

int threads() {
  return thread_count;
}

int hardware_threads() {
  return tbb::info::default_concurrency();
}

void parallel_for(int count, const std::function<void(int)>& task, Schedule schedule) {
  if (thread_count == 1 || count <= 1 || within_task) {
    std::exception_ptr failure;
    for (int i = 0; i < count; ++i) {
      try {
        task(i);
      } catch (...) {
        if (!failure) failure = std::current_exception();
      }
    }
    if (failure) std::rethrow_exception(failure);
    return;
  }
  Loop loop(task);
  const auto run_range = [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i < range.end(); ++i) loop.run(i);
  };
  ready_pool().arena.execute([&] {
    if (schedule == Schedule::kDynamic) {
      tbb::parallel_for(tbb::blocked_range(0, count), run_range, tbb::simple_partitioner());
    } else {
      tbb::parallel_for(tbb::blocked_range(0, count), run_range, tbb::static_partitioner());
    }
  });
  loop.finish();
}

}  // namespace graphdrl
