#include "graphdrl/io/node_ids.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace graphdrl {
namespace {

// The number that is spelled like this and no other way.
std::optional<std::uint64_t> number_of(std::string_view id) {
  std::uint64_t number = 0;
  const char* const end = id.data() + id.size();
  const auto [rest, error] = std::from_chars(id.data(), end, number);
  const bool leading_zero = id.size() > 1 && id.front() == '0';
  if (error != std::errc() || rest != end || leading_zero) return std::nullopt;
  return number;
}

std::string_view as_text(const fmt::format_int& number) {
  return {number.data(), number.size()};
}

}  // namespace

bool NodeIds::add(std::uint64_t id) {
  if (!plain()) return add(as_text(fmt::format_int(id)));
  if (id == static_cast<std::uint64_t>(count_)) {
    ++count_;
    return true;
  }
  if (find(id) != kNoNode) return false;
  spell_out();
  return add(as_text(fmt::format_int(id)));
}

bool NodeIds::add(std::string_view id) {
  if (plain()) {
    if (const auto number = number_of(id)) return add(*number);
    spell_out();
  }
  if (nodes_.find(id) != nodes_.end()) return false;
  labels_->emplace_back(id);
  nodes_.insert(count_++);
  return true;
}

NodeId NodeIds::find(std::uint64_t id) const {
  if (!plain()) return find(as_text(fmt::format_int(id)));
  return id < static_cast<std::uint64_t>(count_) ? static_cast<NodeId>(id) : kNoNode;
}

NodeId NodeIds::find(std::string_view id) const {
  if (plain()) {
    const auto number = number_of(id);
    return number ? find(*number) : kNoNode;
  }
  const auto node = nodes_.find(id);
  return node == nodes_.end() ? kNoNode : *node;
}

std::vector<std::string> NodeIds::take_labels() {
  Labels labels;
  if (!plain()) labels = std::move(*labels_);
  *this = NodeIds();
  return labels;
}

void NodeIds::spell_out() {
  labels_ = std::make_unique<Labels>();
  nodes_ = decltype(nodes_)(0, Hash{labels_.get()}, Equal{labels_.get()});
  for (NodeId node = 0; node < count_; ++node) {
    labels_->push_back(std::to_string(node));
    nodes_.insert(node);
  }
}

}  // namespace graphdrl
