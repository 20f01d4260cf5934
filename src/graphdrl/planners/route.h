// A walk as the order in which it makes for its targets, changed in place and back again.
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/planners/targets.h"

namespace graphdrl {

// A doubly linked list from target 0 to the end. Labels of targets ascend along it, so that before() is O(1) and
// inserting renumbers nothing [Dietz 1982]. Changes since keep() can be undone.
class Route {
 public:
  static constexpr int kNone = -1;

  explicit Route(const Targets& targets) : targets_(&targets), stops_(targets.end() + 1) {}

  // Starts anew. links: the cost of the way to each of `order`, and to the end; used where Targets know none.
  void assign(const std::vector<int>& order, const std::vector<double>& links);

  bool contains(int target) const { return stops_[target].next != kNone; }  // not of the end
  int next(int target) const { return stops_[target].next; }
  int previous(int target) const { return stops_[target].previous; }
  double link(int target) const { return stops_[target].link; }  // the cost of the way to the next
  bool before(int one, int other) const { return stops_[one].label < stops_[other].label; }
  double cost() const { return cost_; }
  double prize() const { return prize_; }

  // in, out: the costs of the ways to it and on.
  void insert(int target, int after, double in, double out);
  // If the direct cost is unknown, the link keeps the sum of both old links, an upper bound.
  void remove(int target);
  // Reverses the order from `first` to `last`. in, out: the costs of the ways to `last`, and on from `first`.
  // REQUIRES: edges lead both ways.
  void reverse(int first, int last, double in, double out);

  // Says what the way on from a target costs.
  void relink(int target, double link);

  void keep() {
    changes_.clear();
    kept_cost_ = cost_;
    kept_prize_ = prize_;
  }
  void undo();
  double kept_cost() const { return kept_cost_; }
  double kept_prize() const { return kept_prize_; }
  // Calls touch(target, other) for every change since keep(): what was changed, and what it came after, or kNone.
  template <typename Touch>
  void changed(const Touch& touch) const {
    for (const Change& change : changes_) touch(change.target, change.other);
  }

 private:
  static constexpr std::int64_t kGap = std::int64_t{1} << 32;       // between labels
  static constexpr std::int64_t kLeastGap = std::int64_t{1} << 16;  // where room was made
  static constexpr int kFirstReach = 16;                            // targets each way
  struct Stop {
    int next = kNone;
    int previous = kNone;
    double link = 0;
    std::int64_t label = 0;
  };
  enum class Kind { kInserted, kRemoved, kReversed, kRelinked };
  struct Change {
    Kind kind;
    int target;  // the first after a reversal
    int other;   // it stood after this one; the last after a reversal
    double in;   // old links; of kRelinked the link on alone
    double out;
  };

  void connect(int from, int to, double link);
  double known_or(double link, int from, int to) const;  // the cost that Targets know, else `link`
  void put(int target, int after, double in, double out);
  void take(int target, double link);
  void turn(int first, int last, double in, double out);
  void make_room(int target);
  void renumber();

  const Targets* targets_;
  std::vector<Stop> stops_;
  std::vector<Change> changes_;
  std::vector<int> turned_;  // scratch
  std::vector<std::int64_t> labels_;
  double cost_ = 0;
  double prize_ = 0;
  double kept_cost_ = 0;
  double kept_prize_ = 0;
};

}  // namespace graphdrl
