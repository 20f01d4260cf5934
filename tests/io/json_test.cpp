#include "graphdrl/io/json.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support.h"

namespace graphdrl {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string nested(int depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Json, IsParsedUpToTheDepthLimit) {
  EXPECT_EQ(parse_json(nested(kMaxJsonDepth), "f").size(), 1u);
  EXPECT_THAT(error_of([] { parse_json(fmt::format("\n{}", nested(kMaxJsonDepth + 1)), "f"); }),
              HasSubstr("f:2: the JSON is nested too deeply: expected at most 100 levels"));
  EXPECT_THAT(error_of([] { parse_json(std::string(1'000'000, '{'), "f"); }), HasSubstr("nested too deeply"));
  EXPECT_TRUE(parse_json_or_discard(nested(kMaxJsonDepth)).is_array());
  EXPECT_TRUE(parse_json_or_discard(nested(1'000'000)).is_discarded());
}

TEST(Json, BracketsInTextsAreNotNested) {
  const std::string text = json({"\\\"" + std::string(200, '[') + "\"", "\\"}).dump();
  EXPECT_EQ(parse_json(text, "f").size(), 2u);
  EXPECT_EQ(parse_json(std::string("[") + std::string(300, ' ') + "[],[],[[]]]", "f").size(), 3u);
}

TEST(Json, ErrorsNameTheLine) {
  EXPECT_THAT(error_of([] { parse_json("{\n\"a\": ]", "f", "a list of maps"); }),
              HasSubstr("f:2: not JSON: expected a list of maps"));
  EXPECT_THAT(error_of([] { parse_json("[1e999]", "f"); }), HasSubstr("f: a number too large"));
  EXPECT_TRUE(parse_json_or_discard("[1").is_discarded());
}

TEST(Json, IsShortenedWithoutRecursion) {
  EXPECT_EQ(shortened(json::parse(R"({"a":[1,2.5,null,"ö\n"],"b":{}})")), R"('{"a":[1,2.5,null,"ö\n"],"b":{}}')");
  EXPECT_EQ(shortened(json(std::vector<int>(1000, 7)), 6), "'[7,7,7…'");
  const json deep = json::parse(nested(1'000'000));
  EXPECT_EQ(shortened(deep), fmt::format("'{}…'", std::string(60, '[')));
  EXPECT_LE(shortened(deep, 10'000).size(), 300u);
}

}  // namespace
}  // namespace graphdrl
