// What a file calls its nodes.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// Different texts, in the order given. Takes no memory while the ids are 0, 1, 2 …
class NodeIds {
 public:
  NodeIds() = default;
  NodeIds(const NodeIds&) = delete;  // nodes_ looks into labels_

  // Gives the id to the next node. False, and nothing changes, where a node has it already.
  bool add(std::string_view id);
  // The node with this id; kNoNode where there is none.
  NodeId find(std::string_view id) const;

  NodeId count() const { return count_; }
  std::string text(NodeId node) const { return labels_.empty() ? std::to_string(node) : labels_[node]; }

  // Every id; empty where they are 0 … N - 1. Nothing is left.
  std::vector<std::string> take_labels();

 private:
  NodeId count_ = 0;
  std::deque<std::string> labels_;                      // empty while the ids are 0 … N - 1
  std::unordered_map<std::string_view, NodeId> nodes_;  // by their labels
};

}  // namespace graphdrl
