#include "graphdrl/io/safetensors.h"

#include <gmock/gmock.h>

#include <cstring>

#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string file_with(const std::string& header, std::size_t data_bytes) {
  const std::uint64_t length = header.size();
  std::string content(reinterpret_cast<const char*>(&length), 8);
  return content + header + std::string(data_bytes, '\0');
}

std::string error_for(const std::string& content) {
  return error_of([&] { Safetensors::parse(content, "f"); });
}

TEST(Safetensors, RoundTrips) {
  const TemporaryFolder folder;
  const std::vector<float> a = {1, 2, 3, 4, 5, 6};
  const std::vector<std::int64_t> b = {-7};
  const std::vector<TensorView> tensors = {{"a", {2, 3}, std::span(a)}, {"b", {1}, std::span(b)}};
  write_safetensors(folder / "f", tensors, {{"key", "väl\"ue"}});
  const Safetensors file = Safetensors::read(folder / "f");
  EXPECT_EQ(file.get<float>("a", {2, 3}), a);
  EXPECT_EQ(file.get<std::int64_t>("b", {1}), b);
  EXPECT_EQ(file.metadata().at("key"), "väl\"ue");
  EXPECT_EQ(file.entries()[1].name, "b");
  EXPECT_THAT(error_of([&] { file.get<float>("a", {3, 2}); }), HasSubstr("expected [3, 2], got [2, 3]"));
  EXPECT_THAT(error_of([&] { file.get<double>("a", {2, 3}); }), HasSubstr("wrong type: expected F64, got F32"));
  EXPECT_THAT(error_of([&] { file.get<float>("c", {}); }), HasSubstr("'c' is missing"));
}

TEST(Safetensors, WritesTheHeaderByTheBook) {
  const TemporaryFolder folder;
  const std::vector<float> a = {1};
  const std::vector<TensorView> tensors = {{"a", {1}, std::span(a)}};
  write_safetensors(folder / "f", tensors, {});
  const std::string content = read_file(folder / "f");
  std::uint64_t length = 0;
  std::memcpy(&length, content.data(), 8);
  EXPECT_EQ(length % 8, 0u);
  EXPECT_THAT(content.substr(8, length), HasSubstr(R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]})"));
}

TEST(Safetensors, RefusesWhatLiesOutsideOverlapsOrOverflows) {
  EXPECT_EQ(error_for(file_with(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 4)), "");
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 3)),
              HasSubstr("outside the file"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 5)),
              HasSubstr("belongs to no tensor"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,4]}})", 4)),
              HasSubstr("expected 8 bytes for [2], got 4"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}})", 0)),
              HasSubstr("overflows"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},)"
                                  R"("b":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})",
                                  4)),
              HasSubstr("overlaps"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", 4)),
              HasSubstr("strange shape"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F31","shape":[1],"data_offsets":[0,4]}})", 4)),
              HasSubstr("unknown type"));
  EXPECT_THAT(error_for(file_with(R"({"a":7})", 0)), HasSubstr("not described"));
  EXPECT_THAT(error_for(file_with(R"({"__metadata__":{"a":1}})", 0)), HasSubstr("metadata"));
  EXPECT_THAT(error_for(file_with("[]", 0)), HasSubstr("a header in JSON"));
  EXPECT_THAT(error_for(std::string(8, '\xff')), HasSubstr("not a whole safetensors file"));
}

TEST(Safetensors, SurvivesDeepNesting) {
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[)" + deep + R"(],"data_offsets":[0,4]}})", 4)),
              HasSubstr("not a safetensors file"));
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[)" + deep + ",4]}})", 4)),
              HasSubstr("not a safetensors file"));
  const std::string shape = std::string(90, '[') + std::string(90, ']');
  EXPECT_THAT(error_for(file_with(R"({"a":{"dtype":"F32","shape":[)" + shape + R"(],"data_offsets":[0,4]}})", 4)),
              HasSubstr("whole numbers, got '" + std::string(60, '[')));
}

TEST(Safetensors, WithAChecksumIsRefusedWithAnyFlippedBit) {
  const std::vector<float> a = {1, 2, 3};
  const std::vector<TensorView> tensors = {{"a", {3}, std::span(a)}, {"b", {1, 3}, std::span(a)}};
  const std::string whole = format_safetensors(tensors, {{"layout", "3"}, {"progress", "1e5"}});
  const auto error_of_use = [](const std::string& content) {
    return error_of([&] { Safetensors::parse(content, "f").require_checksum(); });
  };
  EXPECT_EQ(error_of_use(whole), "");
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    EXPECT_NE(error_of_use(flipped), "") << bit;
  }
  EXPECT_EQ(error_for(file_with(R"({"__metadata__":{"layout":"2"}})", 0)), "");
  EXPECT_THAT(error_of_use(file_with(R"({"__metadata__":{"layout":"3"}})", 0)), HasSubstr("checksum is missing"));
}

// Another writer's order of keys and its spaces make no difference; the rule is in safetensors.h.
TEST(Safetensors, HaveAChecksumThatOthersCanCompute) {
  const std::string data(4, '\0');
  const std::string sum =
      checksum({R"({"__metadata__":{"k":"v"},"a":{"data_offsets":[0,4],"dtype":"F32","shape":[1]}})", data});
  const std::string header =
      R"({ "a": {"dtype": "F32", "shape": [1], "data_offsets": [0, 4]}, "__metadata__": {"xxh3_64": ")" + sum +
      R"(", "k": "v"}})";
  EXPECT_EQ(error_for(file_with(header, 4)), "");
  EXPECT_EQ(checksum({}), "2d06800538d394c2");  // the hash of nothing, in xxHash's specification
  EXPECT_EQ(checksum({"1234", "56789"}), checksum({"123456789"}));
}

TEST(Safetensors, EveryTruncationIsAnErrorAndNoDamageACrash) {
  const TemporaryFolder folder;
  const std::vector<float> a = {1, 2, 3};
  const std::vector<std::uint16_t> b = {1, 2};
  const std::vector<TensorView> tensors = {{"a", {3}, std::span(a)}, {"b", {2, 1}, std::span(b)}};
  write_safetensors(folder / "f", tensors, {{"k", "v"}});
  const std::string whole = read_file(folder / "f");
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(error_for(whole.substr(0, size)), "") << size;
  Rng rng(5);
  for (int i = 0; i < 20'000; ++i) {
    std::string damaged = whole;
    for (std::uint32_t n = 1 + rng.below(3); n > 0; --n) {
      damaged[rng.below(static_cast<std::uint32_t>(whole.size()))] = static_cast<char>(rng.below(256));
    }
    error_for(damaged);
  }
}

}  // namespace
}  // namespace graphdrl
