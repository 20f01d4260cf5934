// What a file calls its nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// Different texts, in the order given; a whole number is the text of its digits. Takes no memory while the ids are 0,
// 1, 2 …
class NodeIds {
 public:
  // Gives the id to the next node. False, and nothing changes, where a node has it already.
  bool add(std::string_view id);
  bool add(std::uint64_t id);

  // The node with this id; kNoNode where there is none.
  NodeId find(std::string_view id) const;
  NodeId find(std::uint64_t id) const;

  NodeId count() const { return count_; }
  std::string text(NodeId node) const { return plain() ? std::to_string(node) : (*labels_)[node]; }

  // Every id; empty where they are 0 … N - 1. Nothing is left.
  std::vector<std::string> take_labels();

 private:
  using Labels = std::vector<std::string>;

  // Nodes by the hash of their labels, so that labels are stored once.
  struct Hash {
    using is_transparent = void;
    const Labels* labels;
    std::size_t operator()(std::string_view id) const { return std::hash<std::string_view>()(id); }
    std::size_t operator()(NodeId node) const { return (*this)((*labels)[node]); }
  };
  struct Equal {
    using is_transparent = void;
    const Labels* labels;
    std::string_view text(NodeId node) const { return (*labels)[node]; }
    std::string_view text(std::string_view id) const { return id; }
    template <typename One, typename Other>
    bool operator()(const One& one, const Other& other) const {
      return text(one) == text(other);
    }
  };

  bool plain() const { return labels_ == nullptr; }
  void spell_out();

  NodeId count_ = 0;
  std::unique_ptr<Labels> labels_;  // null while the ids are 0 … N - 1
  std::unordered_set<NodeId, Hash, Equal> nodes_{0, Hash{nullptr}, Equal{nullptr}};
};

}  // namespace graphdrl
