// The candidates of a beam's next level, of which only the best can be kept.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

inline constexpr std::size_t kRankings = 3;
using Rankings = std::array<double, kRankings>;  // lower is better

// A partial walk with one more first visit, not built yet.
struct Candidate {
  int parent = 0;
  NodeId node = kNoNode;
  double spent = 0;
  double penalties = 0;
  Rankings rankings = {};
  std::uint64_t visited_hash = 0;  // of the visited set
};
// With room to grow, and up to four slots of the table of states.
inline constexpr double kCandidateBytes = 2 * sizeof(Candidate) + 96;

// Candidates of different states (visited set and position). Of two that lead to one state the cheaper stays, of two as
// cheap the one of the lower parent, with the better of their first rankings.
class BestStates {
 public:
  // width: how many will be kept at most.
  explicit BestStates(std::size_t width);

  void clear();
  bool empty() const { return candidates_.empty(); }
  std::span<const Candidate> all() const { return candidates_; }

  void add(const Candidate& candidate);

  // Candidates of this parent follow.
  void begin_parent(int parent);

  // A candidate of this parent that is above this by every ranking will not be kept: enough others come before it by
  // each. Of equals, those of lower parents do.
  const Rankings& worst_useful() const { return worst_useful_; }
  bool is_useless(const Rankings& rankings) const {
    return rankings[0] > worst_useful_[0] && rankings[1] > worst_useful_[1] && rankings[2] > worst_useful_[2];
  }

  // Keeps `width` at most: a third by each ranking, the first third by the first. Gives whether any had to go.
  bool keep_best();

  // Sorts what stands from a place on by one ranking.
  void sort(std::size_t ranking, int from);

 private:
  static constexpr std::size_t kLeastSlots = 64;
  // What candidates are ordered by; node ids break ties later.
  struct Standing {
    double ranking;
    int parent;
    bool operator<(const Standing& other) const {
      return ranking != other.ranking ? ranking < other.ranking : parent < other.parent;
    }
  };
  struct Slot {
    std::uint64_t hash = 0;
    std::uint32_t generation = 0;  // whose slot it is; an older one's is free
    std::uint32_t place = 0;
  };
  void note(const Candidate& candidate);
  void update_worst_useful();
  void grow();
  // The slot of a state's hash: its own, or the free one where it belongs.
  Slot& slot_of(std::uint64_t hash);

  std::size_t width_;
  std::vector<Candidate> candidates_;
  std::vector<Slot> slots_;  // a power of two; open addressing
  std::uint32_t generation_ = 0;
  // How many are kept by each ranking and those before it, and heaps of as many of the best by it, the worst on top.
  std::array<std::size_t, kRankings> shares_{};
  std::array<std::vector<Standing>, kRankings> best_;
  int parent_ = 0;
  Rankings worst_useful_{};
};

}  // namespace graphdrl
