// Ranks that are threads of one process, for tests of what ranks share.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "graphdrl/base/ranks.h"

namespace graphdrl {

// What they share.
class ThreadJob {
 public:
  explicit ThreadJob(int size) : size_(size), texts_(size) {}

  int size() const { return size_; }

  // All come, then all have what each brought.
  std::vector<std::string> meet(int rank, const std::string& own) {
    std::unique_lock lock(mutex_);
    texts_[rank] = own;
    if (++here_ == size_) {
      all_ = texts_;
      here_ = 0;
      ++meetings_;
      changed_.notify_all();
    } else {
      const int meeting = meetings_;
      changed_.wait(lock, [&] { return meetings_ != meeting || lost_; });
      if (meetings_ == meeting) throw RankLost("another rank has failed");
    }
    return all_;
  }
  void lose() {
    const std::lock_guard lock(mutex_);
    lost_ = true;
    changed_.notify_all();
  }

  std::shared_ptr<TaskQueue> queue;  // written by rank 0 between two meetings

 private:
  int size_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> texts_;
  std::vector<std::string> all_;
  int here_ = 0;
  int meetings_ = 0;
  bool lost_ = false;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(ThreadJob& job, int rank) : job_(job), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return job_.size(); }
  std::vector<std::string> gather(const std::string& own) override { return job_.meet(rank_, own); }
  bool any(bool own) override {
    bool found = false;
    for (const std::string& one : gather(own ? "1" : "")) found = found || !one.empty();
    return found;
  }
  std::unique_ptr<TaskQueue> hand_out(int count) override {
    if (is_first()) job_.queue = one_rank().hand_out(count);
    gather("");
    class Shared final : public TaskQueue {
     public:
      explicit Shared(std::shared_ptr<TaskQueue> queue) : queue_(std::move(queue)) {}
      std::optional<int> next() override { return queue_->next(); }
      void close() override { queue_->close(); }

     private:
      std::shared_ptr<TaskQueue> queue_;
    };
    auto shared = std::make_unique<Shared>(job_.queue);
    gather("");
    return shared;
  }

 private:
  ThreadJob& job_;
  int rank_;
};

// Runs the same on so many ranks. Throws the exception of the lowest rank that has one which is not RankLost.
inline void on_ranks(int size, const std::function<void(Ranks&)>& work) {
  ThreadJob job(size);
  std::vector<std::exception_ptr> failures(size);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(job, rank);
      try {
        work(ranks);
      } catch (const RankLost&) {
        job.lose();
      } catch (...) {
        failures[rank] = std::current_exception();
        job.lose();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace graphdrl
