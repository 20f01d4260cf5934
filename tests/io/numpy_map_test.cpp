#include "graphdrl/io/readers.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string npy(const std::string& type, const std::string& shape, const std::vector<double>& values) {
  const std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}\n", type, shape);
  std::string bytes = "\x93NUMPY\x01";
  bytes += '\0';
  bytes += static_cast<char>(header.size());
  bytes += '\0';
  bytes += header;
  for (const double value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

// Adjacency of a square of four nodes, and the obstacles.
const std::vector<double> kSquare = {0, 1, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0,  //
                                     0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};

TEST(NumpyMap, IsAGridWhereItsEdgesAre) {
  const AnyMap any = parse_numpy_map(npy("<f8", "(2, 4, 4)", kSquare), "file");
  const GridMap& map = std::get<GridMap>(any);
  EXPECT_EQ(map.rows, 2);
  EXPECT_THAT(map.blocked, ElementsAre(false, true, false, false));
  std::vector<double> without = kSquare;  // the obstacle's edges
  for (const int at : {1, 4, 7, 13}) without[at] = 0;
  EXPECT_TRUE(std::holds_alternative<GridMap>(parse_numpy_map(npy("<f8", "(2, 4, 4)", without), "file")));
  without[6] = without[9] = 1;
  EXPECT_TRUE(std::holds_alternative<GraphMap>(parse_numpy_map(npy("<f8", "(2, 4, 4)", without), "file")));
}

TEST(NumpyMap, HoldsAnyGraph) {
  const AnyMap any = parse_numpy_map(npy("<f8", "(3, 3)", {0, 2.5, 0, 0, 0, 1, 1, 0, 0}), "file");
  const GraphMap& map = std::get<GraphMap>(any);
  EXPECT_TRUE(map.graph.directed());
  EXPECT_EQ(map.graph.edge_count(), 3);
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
}

TEST(NumpyMap, RefusesOtherArrays) {
  const auto complaint = [](const std::string& bytes) { return error_of([&] { parse_numpy_map(bytes, "file"); }); };
  EXPECT_THAT(complaint("\x93NUMPY"), HasSubstr("the file ends within the header"));
  EXPECT_THAT(complaint(npy("<f8", "(2, 4, 4)", kSquare).substr(0, 200)), HasSubstr("the file ends within the array"));
  EXPECT_THAT(complaint(npy("<f8", "(10000000, 10000000)", {})), HasSubstr("an array of another shape"));
  EXPECT_THAT(complaint(npy("<f8", "(3, 4, 4)", kSquare)), HasSubstr("an array of another shape"));
  EXPECT_THAT(complaint(npy("<f8", "(4,", kSquare)), HasSubstr("shape"));
  EXPECT_THAT(complaint(npy("<f8", "4", kSquare)), HasSubstr("bad shape"));
  EXPECT_THAT(complaint(npy("<f8", "", kSquare)), HasSubstr("bad shape"));
  EXPECT_THAT(complaint(npy("<c16", "(2, 4, 4)", kSquare)), HasSubstr("an array of another type"));
  EXPECT_THAT(complaint(npy("<f8", "(2, 2)", {0, -1, 0, 0})), HasSubstr("bad value at [0, 1]"));
  EXPECT_THAT(complaint(npy("<f8", "(2, 1, 1)", {0, 1})), HasSubstr("no free node"));
}

}  // namespace
}  // namespace graphdrl
