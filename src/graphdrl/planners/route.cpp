#include "graphdrl/planners/route.h"

#include <algorithm>

namespace graphdrl {

void Route::assign(const std::vector<int>& order, const std::vector<double>& links) {
  const int end = targets_->end();
  std::fill(stops_.begin(), stops_.end(), Stop());
  cost_ = 0;
  prize_ = targets_->prize(0) + targets_->prize(end);
  int last = 0;
  for (std::size_t i = 0; i <= order.size(); ++i) {
    const int target = i < order.size() ? order[i] : end;
    connect(last, target, known_or(links[i], last, target));
    cost_ += stops_[last].link;
    if (target != end) prize_ += targets_->prize(target);
    last = target;
  }
  renumber();
  keep();
}

double Route::known_or(double link, int from, int to) const {
  const double known = targets_->cost(from, to);
  if (known == kNoLimit) return link;
  return targets_->metric() ? std::min(known, link) : known;  // less by rounding alone
}

void Route::insert(int target, int after, double in, double out) {
  changes_.push_back({Kind::kInserted, target, after, stops_[after].link, 0});
  put(target, after, in, out);
}

void Route::remove(int target) {
  const Stop& stop = stops_[target];
  const double in = stops_[stop.previous].link;
  changes_.push_back({Kind::kRemoved, target, stop.previous, in, stop.link});
  take(target, known_or(in + stop.link, stop.previous, stop.next));
}

void Route::reverse(int first, int last, double in, double out) {
  changes_.push_back({Kind::kReversed, last, first, stops_[stops_[first].previous].link, stops_[last].link});
  turn(first, last, in, out);
}

void Route::relink(int target, double link) {
  Stop& stop = stops_[target];
  changes_.push_back({Kind::kRelinked, target, kNone, stop.link, 0});
  cost_ += link - stop.link;
  stop.link = link;
}

void Route::undo() {
  for (; !changes_.empty(); changes_.pop_back()) {
    const Change& change = changes_.back();
    switch (change.kind) {
      case Kind::kInserted:
        take(change.target, change.in);
        break;
      case Kind::kRemoved:
        put(change.target, change.other, change.in, change.out);
        break;
      case Kind::kReversed:
        turn(change.target, change.other, change.in, change.out);
        break;
      case Kind::kRelinked:
        stops_[change.target].link = change.in;
        break;
    }
  }
  cost_ = kept_cost_;  // to the last bit
  prize_ = kept_prize_;
}

void Route::connect(int from, int to, double link) {
  stops_[from].next = to;
  stops_[from].link = link;
  stops_[to].previous = from;
}

void Route::put(int target, int after, double in, double out) {
  const Stop before = stops_[after];
  cost_ += in + out - before.link;
  prize_ += targets_->prize(target);
  stops_[target].label = before.label + (stops_[before.next].label - before.label) / 2;
  connect(after, target, in);
  connect(target, before.next, out);
  if (stops_[target].label == before.label) make_room(target);
}

void Route::take(int target, double link) {
  Stop& stop = stops_[target];
  cost_ += link - stops_[stop.previous].link - stop.link;
  prize_ -= targets_->prize(target);
  connect(stop.previous, stop.next, link);
  stop.next = kNone;
}

void Route::turn(int first, int last, double in, double out) {
  int previous = stops_[first].previous;
  const int after = stops_[last].next;
  cost_ += in + out - stops_[previous].link - stops_[last].link;
  turned_.clear();
  labels_.clear();
  for (int target = first; target != after; target = stops_[target].next) {
    turned_.push_back(target);
    labels_.push_back(stops_[target].label);
  }
  double link = in;
  for (const std::int64_t label : labels_) {
    const int target = turned_.back();
    turned_.pop_back();
    connect(previous, target, link);
    stops_[target].label = label;
    // The way on is the one that led here, turned round.
    link = turned_.empty() ? out : stops_[turned_.back()].link;
    previous = target;
  }
  connect(previous, after, link);
}

// Spreads the labels around a target, over as many neighbours as it takes [Dietz and Sleator 1987].
void Route::make_room(int target) {
  const int end = targets_->end();
  int first = target;
  int last = target;
  std::int64_t count = 0;
  for (int reach = kFirstReach; first != 0 || last != end; reach *= 2) {
    for (int i = 0; i < reach && first != 0; ++i, ++count) first = stops_[first].previous;
    for (int i = 0; i < reach && last != end; ++i, ++count) last = stops_[last].next;
    const std::int64_t gap = (stops_[last].label - stops_[first].label) / count;
    if (gap < kLeastGap) continue;
    std::int64_t label = stops_[first].label;
    for (int i = first; i != last; i = stops_[i].next, label += gap) stops_[i].label = label;
    return;
  }
  renumber();
}

void Route::renumber() {
  std::int64_t label = 0;
  for (int target = 0; target != targets_->end(); target = stops_[target].next, label += kGap) {
    stops_[target].label = label;
  }
  stops_[targets_->end()].label = label;
}

}  // namespace graphdrl
