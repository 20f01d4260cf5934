#include "graphdrl/io/node_ids.h"

#include <charconv>
#include <iterator>

namespace graphdrl {
namespace {

// The number that is spelled like this and no other way; kNoNode where there is none.
NodeId number_of(std::string_view id) {
  NodeId number = 0;
  const char* const end = id.data() + id.size();
  const auto [rest, error] = std::from_chars(id.data(), end, number);
  const bool one_spelling = !id.starts_with('-') && (id.size() == 1 || !id.starts_with('0'));
  return error == std::errc() && rest == end && one_spelling ? number : kNoNode;
}

}  // namespace

bool NodeIds::add(std::string_view id) {
  const bool next_number = labels_.empty() && number_of(id) == count_;
  if (!next_number) {
    if (find(id) != kNoNode) return false;
    const auto append = [this](std::string_view label) {
      const auto node = static_cast<NodeId>(labels_.size());
      nodes_.emplace(labels_.emplace_back(label), node);
    };
    while (std::ssize(labels_) < count_) append(std::to_string(labels_.size()));  // those before are spelled out
    append(id);
  }
  ++count_;
  return true;
}

NodeId NodeIds::find(std::string_view id) const {
  if (labels_.empty()) {
    const NodeId number = number_of(id);
    return number < count_ ? number : kNoNode;
  }
  const auto node = nodes_.find(id);
  return node == nodes_.end() ? kNoNode : node->second;
}

std::vector<std::string> NodeIds::take_labels() {
  std::vector<std::string> labels(std::make_move_iterator(labels_.begin()), std::make_move_iterator(labels_.end()));
  count_ = 0;
  nodes_.clear();
  labels_.clear();
  return labels;
}

}  // namespace graphdrl
