#include "graphdrl/planners/visited_sets.h"

#include <algorithm>
#include <bit>

namespace graphdrl {
namespace {

constexpr int kLevelsPerSettling = 16;  // so that it costs little beside copying the rows of as many levels

std::uint64_t bit_of(std::int32_t place) {
  return std::uint64_t{1} << (place % 64);
}

}  // namespace

void VisitedSets::give_place(NodeId node) {
  if (place_[node] != kNoPlace) return;
  if (free_.empty()) {
    free_.push_back(static_cast<std::int32_t>(node_at_.size()));
    node_at_.push_back(kNoNode);
  }
  place_[node] = free_.back();
  node_at_[free_.back()] = node;
  free_.pop_back();
}

void VisitedSets::advance(std::span<const Candidate> children) {
  for (const Candidate& child : children) give_place(child.node);
  const std::size_t words = (node_at_.size() + 63) / 64;
  next_.assign(children.size() * words, 0);
  for (std::size_t i = 0; i < children.size(); ++i) {
    std::uint64_t* const row = next_.data() + i * words;
    std::copy_n(rows_.data() + children[i].parent * words_, std::min(words_, words), row);
    const std::int32_t place = place_[children[i].node];
    row[place / 64] |= bit_of(place);
  }
  rows_.swap(next_);
  words_ = words;
  if (children.size() == 1 || ++levels_ % kLevelsPerSettling == 0) settle_what_all_agree_on(children.size());
}

void VisitedSets::settle_what_all_agree_on(std::size_t walks) {
  for (std::size_t word = 0; word < words_; ++word) {
    std::uint64_t all = ~std::uint64_t{0};
    std::uint64_t any = 0;
    for (std::size_t walk = 0; walk < walks; ++walk) {
      all &= rows_[walk * words_ + word];
      any |= rows_[walk * words_ + word];
    }
    const std::uint64_t settled = all | ~any;
    for (std::uint64_t rest = settled; rest != 0; rest &= rest - 1) {
      const std::size_t place = 64 * word + static_cast<std::size_t>(std::countr_zero(rest));
      if (place >= node_at_.size()) break;
      const NodeId node = node_at_[place];
      if (node == kNoNode) continue;
      if ((all >> (place % 64) & 1) != 0) common_.insert(node);
      place_[node] = kNoPlace;
      node_at_[place] = kNoNode;
      free_.push_back(static_cast<std::int32_t>(place));
    }
    for (std::size_t walk = 0; walk < walks; ++walk) rows_[walk * words_ + word] &= ~settled;
  }
  // Free places at the end are given back, so that rows become shorter again.
  while (!node_at_.empty() && node_at_.back() == kNoNode) node_at_.pop_back();
  std::erase_if(free_, [&](std::int32_t place) { return place >= std::ssize(node_at_); });
}

}  // namespace graphdrl
