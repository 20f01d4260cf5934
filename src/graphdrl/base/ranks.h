// The processes of one job that work together: this one alone, or those that mpirun starts (mpi/, the only folder that
// sees MPI). Results never depend on how many there are.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace graphdrl {

// Tasks 0 … count - 1, of which each goes to one rank and one thread, whoever is free.
class TaskQueue {
 public:
  virtual ~TaskQueue() = default;
  // The next one; nothing once all are given. On any thread.
  virtual std::optional<int> next() = 0;
  // No rank gets any more. On any thread.
  virtual void close() = 0;
};

// Another rank has failed or gone: what it had to say is said elsewhere.
class RankLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What is called collective is called by every rank, in the same order, by one thread at a time. It throws RankLost
// where another rank has failed.
class Ranks {
 public:
  virtual ~Ranks() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  bool alone() const { return size() == 1; }
  // The rank that writes what all share.
  bool is_first() const { return rank() == 0; }

  // Collective: what each rank has, by rank.
  virtual std::vector<std::string> gather(const std::string& own) = 0;
  // Collective: whether it is true on any rank.
  virtual bool any(bool own) = 0;
  // Collective: hands out tasks. One queue at a time.
  virtual std::unique_ptr<TaskQueue> hand_out(int count) = 0;

  // Collective: throws Error on every rank unless all have the same. what: "options".
  void require_same(const std::string& what, const std::string& own);
  // Collective: the first rank does it, and the others wait. Throws on every rank where it throws: its exception there,
  // RankLost elsewhere.
  void on_first(const std::function<void()>& work);
};

// This process by itself. Any number of threads may use it at once.
Ranks& one_rank();

// A sum over shards, in the order of a balanced binary tree, so that it is the same for any number of ranks. Each rank
// computes some of the shards, which stand next to each other.
class ShardedSum {
 public:
  // REQUIRES: shards is a power of two.
  ShardedSum(Ranks& ranks, int shards);

  int first_shard() const { return first_of(ranks_.rank()); }
  int shard_count() const { return first_of(ranks_.rank() + 1) - first_shard(); }  // of this rank; may be 0

  // Collective. own: [shard_count], all as long as sum.
  void sum(std::span<const std::vector<float>> own, std::span<float> sum);

 private:
  int first_of(int rank) const { return static_cast<int>(std::int64_t{shards_} * rank / ranks_.size()); }
  int owner_of(int first, int count) const;
  template <typename Leaf>
  void add_up(int first, int count, const Leaf& leaf, std::span<float> into);

  Ranks& ranks_;
  int shards_;
};

}  // namespace graphdrl
