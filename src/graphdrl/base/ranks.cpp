#include "graphdrl/base/ranks.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

class CountedTasks final : public TaskQueue {
 public:
  explicit CountedTasks(int count) : count_(count) {}
  std::optional<int> next() override {
    const int task = next_++;
    return task < count_ && !closed_ ? std::optional(task) : std::nullopt;
  }
  void close() override { closed_ = true; }

 private:
  int count_;
  std::atomic<int> next_ = 0;
  std::atomic<bool> closed_ = false;
};

class OneRank final : public Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<std::string> gather(const std::string& own) override { return {own}; }
  bool any(bool own) override { return own; }
  std::unique_ptr<TaskQueue> hand_out(int count) override { return std::make_unique<CountedTasks>(count); }
};

void add(std::span<const float> term, std::span<float> sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += term[i];
}

}  // namespace

Ranks& one_rank() {
  static OneRank rank;
  return rank;
}

void Ranks::require_same(const std::string& what, const std::string& own) {
  if (alone()) return;
  const std::vector<std::string> all = gather(own);
  for (std::size_t other = 1; other < all.size(); ++other) {
    if (all[other] == all[0]) continue;
    throw Error({.what = "rank " + std::to_string(other) + " has other " + what + " than rank 0",
                 .expected = "the same on every rank"});
  }
}

void Ranks::on_first(const std::function<void()>& work) {
  if (is_first()) work();
  any(false);  // where it throws, the others hear of it here
}

ShardedSum::ShardedSum(Ranks& ranks, int shards) : ranks_(ranks), shards_(shards) {}

// The rank that computes all these shards; -1 where there is none.
int ShardedSum::owner_of(int first, int count) const {
  for (int rank = 0; rank < ranks_.size(); ++rank) {
    if (first_of(rank) <= first && first + count <= first_of(rank + 1)) return rank;
  }
  return -1;
}

void ShardedSum::sum(std::span<const std::vector<float>> own, std::span<float> sum) {
  const std::size_t size = sum.size();
  // The sum of shards that are this rank's.
  const auto own_sum = [&](const auto& again, int first, int count, std::span<float> into) -> void {
    if (count == 1) {
      std::ranges::copy(own[first - first_shard()], into.begin());
      return;
    }
    again(again, first, count / 2, into);
    std::vector<float> right(size);
    again(again, first + count / 2, count / 2, right);
    add(right, into);
  };
  if (ranks_.alone()) return own_sum(own_sum, 0, shards_, sum);

  // Each rank sends the sums of the largest subtrees that are its own, from left to right.
  std::string sent;
  std::vector<float> subtree(size);
  const auto send = [&](const auto& again, int first, int count) -> void {
    const int owner = owner_of(first, count);
    if (owner == ranks_.rank()) {
      own_sum(own_sum, first, count, subtree);
      sent.append(reinterpret_cast<const char*>(subtree.data()), size * sizeof(float));
    } else if (owner < 0) {
      again(again, first, count / 2);
      again(again, first + count / 2, count / 2);
    }
  };
  send(send, 0, shards_);
  const std::vector<std::string> received = ranks_.gather(sent);
  std::vector<std::size_t> read(received.size());  // bytes of each
  const auto join = [&](const auto& again, int first, int count, std::span<float> into) -> void {
    const int owner = owner_of(first, count);
    if (owner >= 0) {
      std::memcpy(into.data(), received[owner].data() + read[owner], size * sizeof(float));
      read[owner] += size * sizeof(float);
      return;
    }
    again(again, first, count / 2, into);
    std::vector<float> right(size);
    again(again, first + count / 2, count / 2, right);
    add(right, into);
  };
  join(join, 0, shards_, sum);
}

}  // namespace graphdrl
