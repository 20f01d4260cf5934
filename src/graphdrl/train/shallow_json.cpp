#include "graphdrl/train/shallow_json.h"

#include <fmt/format.h>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {
constexpr int kMaxDepth = 16;  // a training's own files nest three deep
}

nlohmann::ordered_json parse_shallow_json(const std::string& text, const std::string& where) {
  using Json = nlohmann::ordered_json;
  const auto check_depth = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth <= kMaxDepth) return true;
    throw Error(
        {.what = "JSON nested too deeply", .expected = fmt::format("at most {} levels", kMaxDepth), .where = where});
  };
  return Json::parse(text, check_depth, /*allow_exceptions=*/false);
}

}  // namespace graphdrl
