#include "graphdrl/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <optional>

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
std::optional<Pool> pool;  // where thread_count > 1
thread_local bool within_task = false;

// One call of parallel_for.
class Loop {
 public:
  Loop(void (*body)(const void*, int), const void* task) : run_(body), task_(task) { publish(); }

  void run(int i) {
    receive();
    within_task = true;
    try {
      run_(task_, i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_ || i < failed_) {
        failure_ = std::current_exception();
        failed_ = i;
      }
    }
    within_task = false;
    publish();
  }

  // After the last task.
  void finish() {
    receive();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  // ThreadSanitizer does not see how libtbb.so orders a loop's begin, its tasks and its end.
#ifdef __SANITIZE_THREAD__
  void publish() {
    __tsan_release(this);
  }
  void receive() {
    __tsan_acquire(this);
  }
#else
  static void publish() {}
  static void receive() {}
#endif

  void (*run_)(const void*, int);
  const void* task_;
  std::mutex mutex_;
  std::exception_ptr failure_;
  int failed_ = 0;
};

}  // namespace

void set_threads(int threads) {
  thread_count = threads;
  pool.reset();
  if (threads > 1) pool.emplace(threads);
}

int threads() {
  return thread_count;
}

int hardware_threads() {
  return tbb::info::default_concurrency();
}

namespace detail {

bool in_task() {
  return within_task;
}

void run_on_pool(int count, void (*run)(const void* task, int i), const void* task, Schedule schedule) {
  Loop loop(run, task);
  const auto run_range = [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i < range.end(); ++i) loop.run(i);
  };
  pool->arena.execute([&] {
    if (schedule == Schedule::kDynamic) {
      tbb::parallel_for(tbb::blocked_range(0, count), run_range, tbb::simple_partitioner());
    } else {
      tbb::parallel_for(tbb::blocked_range(0, count), run_range, tbb::static_partitioner());
    }
  });
  loop.finish();
}

}  // namespace detail
}  // namespace graphdrl
