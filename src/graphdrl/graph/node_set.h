// Sets of nodes as bits: what a walk has visited.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// A set of the nodes 0 … N - 1, one bit each.
class NodeSet {
 public:
  NodeSet() = default;
  explicit NodeSet(NodeId node_count) { grow(node_count); }

  // The same set among more nodes.
  void grow(NodeId node_count) { words_.resize((static_cast<std::size_t>(node_count) + 63) / 64); }
  void clear() { std::fill(words_.begin(), words_.end(), 0); }

  bool contains(NodeId node) const { return (words_[node / 64] >> (node % 64) & 1) != 0; }
  void insert(NodeId node) { words_[node / 64] |= std::uint64_t{1} << (node % 64); }
  void erase(NodeId node) { words_[node / 64] &= ~(std::uint64_t{1} << (node % 64)); }
  // REQUIRES: both are over the same nodes.
  void insert_all(const NodeSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
  }
  bool empty() const { return words_.empty(); }  // a set over no nodes
  int count() const {
    int sum = 0;
    for (const std::uint64_t word : words_) sum += std::popcount(word);
    return sum;
  }

  friend bool operator==(const NodeSet&, const NodeSet&) = default;

  // For files: bit i % 64 of word i / 64 stands for node i.
  std::vector<std::uint64_t>& words() { return words_; }
  const std::vector<std::uint64_t>& words() const { return words_; }

 private:
  std::vector<std::uint64_t> words_;
};

// One of many sets that differ in few nodes: a set common to all, and a row of bits for the nodes that may differ. A
// plain NodeSet has no such nodes. Refers to both; valid while they live.
class NodeSetView {
 public:
  NodeSetView(const NodeSet&&) = delete;              // it would be gone
  NodeSetView(const NodeSet& set) : common_(&set) {}  // NOLINT(google-explicit-constructor): a set is a view of itself
  // bits: [N], a node's bit in `row`, or -1 where `common` says whether it is in the set.
  NodeSetView(const NodeSet& common, const std::int32_t* bits, const std::uint64_t* row)
      : common_(&common), bits_(bits), row_(row) {}

  bool contains(NodeId node) const {
    if (bits_ == nullptr || bits_[node] < 0) return common_->contains(node);
    return (row_[bits_[node] / 64] >> (bits_[node] % 64) & 1) != 0;
  }

 private:
  const NodeSet* common_;
  const std::int32_t* bits_ = nullptr;
  const std::uint64_t* row_ = nullptr;
};

}  // namespace graphdrl
