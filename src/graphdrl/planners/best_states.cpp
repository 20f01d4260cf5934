#include "graphdrl/planners/best_states.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graphdrl {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Two states of one visited set differ by where they stand.
std::uint64_t state_hash(const Candidate& candidate) {
  std::uint64_t hash = candidate.visited_hash ^ (static_cast<std::uint64_t>(candidate.node) << 32);
  hash = (hash ^ (hash >> 32)) * 0x9fb21c651e98df25ULL;
  return hash ^ (hash >> 29);
}

auto by(std::size_t ranking) {
  return [ranking](const Candidate& a, const Candidate& b) {
    if (a.rankings[ranking] != b.rankings[ranking]) return a.rankings[ranking] < b.rankings[ranking];
    return a.parent != b.parent ? a.parent < b.parent : a.node < b.node;
  };
}

}  // namespace

BestStates::BestStates(std::size_t width) : width_(width), slots_(kLeastSlots) {
  for (std::size_t i = 0; i < kRankings; ++i) shares_[i] = (width * (i + 1) + kRankings - 1) / kRankings;
  clear();
}

void BestStates::clear() {
  candidates_.clear();
  worst_useful_.fill(kUnbounded);
  for (auto& heap : best_) heap.clear();
  if (++generation_ != 0) return;
  std::fill(slots_.begin(), slots_.end(), Slot());
  generation_ = 1;
}

BestStates::Slot& BestStates::slot_of(std::uint64_t hash) {
  std::size_t place = hash & (slots_.size() - 1);
  while (slots_[place].generation == generation_ && slots_[place].hash != hash)
    place = (place + 1) & (slots_.size() - 1);
  return slots_[place];
}

void BestStates::add(const Candidate& candidate) {
  const std::uint64_t hash = state_hash(candidate);
  Slot& slot = slot_of(hash);
  if (slot.generation == generation_) {
    Candidate& known = candidates_[slot.place];
    const double promise = std::min(candidate.rankings[0], known.rankings[0]);
    if (candidate.spent < known.spent || (candidate.spent == known.spent && candidate.parent < known.parent)) {
      known = candidate;
    }
    known.rankings[0] = promise;
    return;
  }
  slot = {.hash = hash, .generation = generation_, .place = static_cast<std::uint32_t>(candidates_.size())};
  candidates_.push_back(candidate);
  note(candidate);
  if (2 * candidates_.size() > slots_.size()) grow();
}

void BestStates::note(const Candidate& candidate) {
  for (std::size_t i = 0; i < kRankings; ++i) {
    std::vector<Standing>& heap = best_[i];
    const Standing place{candidate.rankings[i], candidate.parent};
    if (heap.size() == shares_[i]) {
      if (!(place < heap.front())) continue;
      std::pop_heap(heap.begin(), heap.end());
      heap.back() = place;
    } else {
      heap.push_back(place);
    }
    std::push_heap(heap.begin(), heap.end());
  }
  update_worst_useful();
}

void BestStates::begin_parent(int parent) {
  parent_ = parent;
  update_worst_useful();
}

void BestStates::update_worst_useful() {
  // As long as there are fewer than will be kept, everything is.
  if (candidates_.size() < width_) return;
  for (std::size_t i = 0; i < kRankings; ++i) {
    const auto [ranking, parent] = best_[i].front();
    worst_useful_[i] = parent < parent_ ? std::nextafter(ranking, -kUnbounded) : ranking;
  }
}

void BestStates::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.generation == generation_) slot_of(slot.hash) = slot;
  }
}

bool BestStates::keep_best() {
  const std::size_t kept = std::min(candidates_.size(), width_);
  if (kept == candidates_.size()) return false;
  auto chosen = candidates_.begin();
  for (std::size_t ranking = 0; ranking < kRankings; ++ranking) {
    const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(shares_[ranking]);
    if (chosen < end) std::nth_element(chosen, end, candidates_.end(), by(ranking));
    chosen = end;
  }
  candidates_.resize(kept);
  return true;
}

void BestStates::sort(std::size_t ranking, int from) {
  const auto begin = candidates_.begin() + std::min<std::ptrdiff_t>(from, std::ssize(candidates_));
  std::sort(begin, candidates_.end(), by(ranking));
}

}  // namespace graphdrl
