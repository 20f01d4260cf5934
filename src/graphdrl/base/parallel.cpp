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

// ThreadSanitizer does not see how libtbb.so orders a loop's begin before its tasks and these before its end. Each
// order has a mark of its own: with one for both, the end of a task would order the next one behind it and hide their
// races.
struct OrderMark {
#ifdef __SANITIZE_THREAD__
  void before() {
    __tsan_release(this);
  }
  void after() {
    __tsan_acquire(this);
  }
  char address = 0;
#else
  static void before() {}
  static void after() {}
#endif
};

// One call of parallel_for.
class Loop {
 public:
  Loop(void (*body)(const void*, int), const void* task) : run_(body), task_(task) { begin_.before(); }

  void run(int i) {
    begin_.after();
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
    end_.before();
  }

  // After the last task.
  void finish() {
    end_.after();
    acquire_task_count();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  // oneTBB counts the tasks left in a word of the caller's stack, within 4 KB below this loop. The thread that ends the
  // last task writes it. ThreadSanitizer must see that the caller waited for that, as it uses its stack again.
  void acquire_task_count() {
#ifdef __SANITIZE_THREAD__
    char* const top = reinterpret_cast<char*>(this);
    for (int below = 0; below < 4096; below += 8) __tsan_acquire(top - below);
#endif
  }

  void (*run_)(const void*, int);
  const void* task_;
  OrderMark begin_;
  OrderMark end_;
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
