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

// Adds up shards along the tree. leaf(first, count, into): sets `into` to the sum of these shards and gives true, or
// gives false where its halves are to be added.
template <typename Leaf>
void ShardedSum::add_up(int first, int count, const Leaf& leaf, std::span<float> into) {
  if (leaf(first, count, into)) return;
  add_up(first, count / 2, leaf, into);
  std::vector<float> right(into.size());
  add_up(first + count / 2, count / 2, leaf, right);
  for (std::size_t i = 0; i < into.size(); ++i) into[i] += right[i];
}

void ShardedSum::sum(std::span<const std::vector<float>> own, std::span<float> sum) {
  const auto own_shard = [&](int first, int count, std::span<float> into) {
    if (count == 1) std::ranges::copy(own[first - first_shard()], into.begin());
    return count == 1;
  };
  if (ranks_.alone()) return add_up(0, shards_, own_shard, sum);

  // Each rank sends the sums of the largest subtrees that are its own, from left to right.
  std::string sent;
  std::vector<float> subtree(sum.size());
  const auto send = [&](int first, int count, std::span<float>) {
    const int owner = owner_of(first, count);
    if (owner == ranks_.rank()) {
      add_up(first, count, own_shard, subtree);
      sent.append(reinterpret_cast<const char*>(subtree.data()), sum.size_bytes());
    }
    return owner >= 0;
  };
  add_up(0, shards_, send, sum);
  const std::vector<std::string> received = ranks_.gather(sent);
  std::vector<std::size_t> read(received.size());  // bytes of each
  add_up(
      0, shards_,
      [&](int first, int count, std::span<float> into) {
        const int owner = owner_of(first, count);
        if (owner < 0) return false;
        std::memcpy(into.data(), received[owner].data() + read[owner], into.size_bytes());
        read[owner] += into.size_bytes();
        return true;
      },
      sum);
}

}  // namespace graphdrl
