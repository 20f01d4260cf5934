// What attributes of nodes and edges mean, by the names that programs give them.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

// The one list of what attributes mean. The first name is the best; case does not count.
inline constexpr std::array<std::string_view, 4> kCostNames = {"weight", "cost", "length", "distance"};
inline constexpr std::array<std::string_view, 2> kPrizeNames = {"prize", "score"};
inline constexpr std::array<std::string_view, 1> kEdgePrizeNames = {"prize"};
inline constexpr std::array<std::string_view, 2> kLabelNames = {"label", "name"};
struct PlaceNames {
  std::string_view x;
  std::string_view y;
  std::string_view unit;  // empty where the names do not tell it
};
inline constexpr std::array kPlaceNames = {PlaceNames{"x", "y", ""}, PlaceNames{"lon", "lat", "degrees"},
                                           PlaceNames{"longitude", "latitude", "degrees"}};

// The place of a name among names; behind the last where it is none of them.
std::size_t rank_of(std::string_view name, std::span<const std::string_view> names);
bool is_name_of(std::string_view name, std::span<const std::string_view> names);

// Columns of coordinates: x and y of the first pair of names, of the second …
inline constexpr std::size_t kPlaceColumns = 2 * kPlaceNames.size();
// Which one has this name; kPlaceColumns where none has.
std::size_t place_column(std::string_view name);

struct Attribute {
  std::string name;
  std::string value;
};

// Which attribute is a cost or a prize: the one asked for, none, or the best of the usual names.
class AmountNames {
 public:
  // wanted: empty for the usual names, kNoAttribute for none.
  AmountNames(std::string wanted, std::span<const std::string_view> usual);
  AmountNames(const AmountNames&) = delete;  // names_ may point at wanted_

  bool knows(std::string_view name) const { return is_name_of(name, names_); }
  // The one that counts, the last of those with the best name; null where there is none.
  const Attribute* best(std::span<const Attribute> attributes);
  // Throws Error where the one asked for was never met. owner: "edge" or "node".
  void check(const std::string& owner, const std::string& place) const;
  // "weight and length" where more than one of them was used; else empty.
  std::string mixed() const;

 private:
  std::string wanted_;
  std::vector<std::string_view> names_;
  std::vector<bool> used_;           // [names_]
  std::vector<std::string> others_;  // some that were met where one was asked for, for an error's message
};

}  // namespace graphdrl
