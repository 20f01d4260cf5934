#include "graphdrl/io/attributes.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/io/any_map.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::size_t kNamesShown = 8;  // of attributes, in an error's message

}  // namespace

std::size_t rank_of(std::string_view name, std::span<const std::string_view> names) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](std::string_view one) { return same_name(name, one); });
  return static_cast<std::size_t>(found - names.begin());
}

bool is_name_of(std::string_view name, std::span<const std::string_view> names) {
  return rank_of(name, names) < names.size();
}

std::size_t place_column(std::string_view name) {
  std::size_t column = 0;
  for (const PlaceNames& names : kPlaceNames) {
    if (same_name(name, names.x)) return column;
    if (same_name(name, names.y)) return column + 1;
    column += 2;
  }
  return column;
}

AmountNames::AmountNames(std::string wanted, std::span<const std::string_view> usual) : wanted_(std::move(wanted)) {
  if (wanted_.empty()) names_.assign(usual.begin(), usual.end());
  if (!wanted_.empty() && wanted_ != kNoAttribute) names_ = {wanted_};
  used_.resize(names_.size());
}

const Attribute* AmountNames::best(std::span<const Attribute> attributes) {
  const Attribute* found = nullptr;
  std::size_t best = names_.size();
  for (const Attribute& attribute : attributes) {
    const std::size_t rank = rank_of(attribute.name, names_);
    if (rank < names_.size() && rank <= best) {
      found = &attribute;
      best = rank;
    } else if (!wanted_.empty() && others_.size() < kNamesShown &&
               std::find(others_.begin(), others_.end(), attribute.name) == others_.end()) {
      others_.push_back(attribute.name);
    }
  }
  if (found != nullptr) used_[best] = true;
  return found;
}

void AmountNames::check(const std::string& owner, const std::string& place) const {
  if (wanted_.empty() || names_.empty() || used_.front()) return;
  std::string names;
  for (const std::string& name : others_) names += (names.empty() ? "" : ", ") + escaped(name);
  throw Error({.what = fmt::format("no {} has this attribute", owner),
               .expected = names.empty() ? fmt::format("{}s with attributes", owner) : names,
               .got = in_quotes(wanted_),
               .where = place});
}

std::string AmountNames::mixed() const {
  std::string names;
  int count = 0;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (used_[i]) names += fmt::format("{}{}", count++ == 0 ? "" : " and ", names_[i]);
  }
  return count > 1 ? names : "";
}

}  // namespace graphdrl
