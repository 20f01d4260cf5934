#include "graphdrl/env/world_families.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "graphdrl/graph/components.h"
#include "graphdrl/io/readers.h"
#include "support.h"

namespace graphdrl {
namespace {

using testing::HasSubstr;

// Spells a world out: the same text for the same world only.
std::string spelled(const World& world) {
  std::string text = std::to_string(world.graph().node_count());
  for (const bool blocked : world.blocked()) text += blocked ? '#' : '.';
  for (const Edge& edge : world.open().edges()) {
    text += ' ' + std::to_string(edge.a) + '-' + std::to_string(edge.b) + ':' + std::to_string(edge.cost);
  }
  return text;
}

TEST(WorldFamilies, GiveConnectedWorldsThatAreTheSameEveryTime) {
  for (const WorldFamily& family : world_families()) {
    for (const bool weighted : {false, true}) {
      for (const bool directed : {false, true}) {
        if (family.grid && (weighted || directed)) continue;
        const WorldSpec spec{std::string(family.name), family.grid ? 9 : 40, weighted, directed};
        std::set<std::string> different;
        for (int index = 0; index < 5; ++index) {
          for (const Split split : {Split::kTrain, Split::kValidation, Split::kTest}) {
            const World world = split_world(spec, split, index);
            EXPECT_EQ(find_components(world.graph(), world.blocked()).count(), 1) << spec.name();
            EXPECT_EQ(world.graph().directed(), directed) << spec.name();
            EXPECT_EQ(world.graph().weighted(), weighted) << spec.name();
            EXPECT_EQ(spelled(world), spelled(split_world(spec, split, index)));
            different.insert(spelled(world));
          }
        }
        // Small ones may be the same by chance: there are 15 empty rooms of this size.
        EXPECT_GT(different.size(), family.name == "open" ? 5u : 12u) << spec.name();
      }
    }
  }
}

// Changes where the first world of any of these families' test splits does.
std::uint64_t hash_of(const std::vector<std::string>& families) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const WorldFamily& family : world_families()) {
    if (std::find(families.begin(), families.end(), family.name) == families.end()) continue;
    for (const bool plain : {true, false}) {
      if (family.grid && !plain) continue;
      const WorldSpec spec{std::string(family.name), family.grid ? 11 : 50, !plain, !plain};
      const World world = split_world(spec, Split::kTest, 0);
      const auto add = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3ULL; };
      for (NodeId node = 0; node < world.graph().node_count(); ++node) {
        add(world.is_blocked(node));
        for (int i = 0; i < world.open().degree(node); ++i) {
          add(static_cast<std::uint64_t>(world.open_neighbours(node)[i]));
          add(static_cast<std::uint64_t>(std::llround(1e6 * world.open().cost(node, i))));
        }
      }
    }
  }
  return hash;
}

TEST(WorldFamilies, HaveFrozenSplits) {
  EXPECT_EQ(hash_of({"obstacles", "maze", "loop-maze", "braided-maze", "rooms", "tree", "erdos-renyi",
                     "barabasi-albert", "watts-strogatz", "geometric"}),
            5772697023042949595u);
  EXPECT_EQ(hash_of({"open", "caves", "houses", "streets"}), 8388664832629331339u);
  EXPECT_EQ(hash_of({"room-grid", "power-law-cluster", "balanced-tree", "ladder", "hexagons", "triangles", "torus",
                     "caveman", "road"}),
            5039671854537943988u);
}

TEST(WorldFamilies, HavePlacesWhereTheyHaveALayout) {
  const std::set<std::string_view> placed = {"balanced-tree", "ladder",  "hexagons", "triangles",
                                             "torus",         "caveman", "road"};
  for (const WorldFamily& family : world_families()) {
    if (family.grid) continue;
    const World world = split_world({std::string(family.name), 30, true, true}, Split::kTest, 0);
    EXPECT_EQ(world.has_places(), placed.contains(family.name)) << family.name;
    if (!world.has_places()) continue;
    const std::string text = format_node_link(world.to_map());
    EXPECT_EQ(parse_node_link(text, "text", {}).places.points, world.to_map().places.points) << family.name;
  }
}

TEST(WorldFamilies, HaveTheSizeAskedFor) {
  const auto nodes = [](std::string family, int size) {
    return split_world({std::move(family), size}, Split::kTest, 0).node_count();
  };
  for (const int size : {2, 3, 4, 5, 6, 7, 12, 50, 51, 200}) {
    for (const char* const family : {"power-law-cluster", "balanced-tree", "caveman"}) {
      EXPECT_EQ(nodes(family, size), size) << family;
    }
    EXPECT_EQ(nodes("ladder", size), size / 2 * 2);
    for (const char* const family : {"hexagons", "triangles", "torus"}) {
      const int rows = static_cast<int>(std::sqrt(size));
      EXPECT_EQ(nodes(family, size), size / rows * rows) << family;
    }
  }
}

TEST(WorldFamilies, MeasureRoadsInWholeMetres) {
  const World world = split_world({"road", 200, true}, Split::kTest, 0);
  EXPECT_EQ(world.unit(), "m");
  for (const Edge& edge : world.open().edges()) {
    const Point a = world.place(edge.a);
    const Point b = world.place(edge.b);
    EXPECT_EQ(edge.cost, std::floor(edge.cost));
    EXPECT_GE(edge.cost, std::hypot(a.x - b.x, a.y - b.y) - 1e-6);
  }
}

TEST(WorldFamilies, SayWhatTheyDoNotHave) {
  const auto message = [](const WorldSpec& spec) { return error_of([&] { split_world(spec, Split::kTest, 0); }); };
  EXPECT_THAT(message({"cave", 9}), HasSubstr("no such family"));
  EXPECT_THAT(message({"maze", 8}), HasSubstr("an odd number of cells a side"));
  EXPECT_THAT(message({"tree", 1}), HasSubstr("nodes from 2"));
  EXPECT_THAT(message({"tree", 1'000'001}), HasSubstr("nodes from 2 to 1000000"));
  EXPECT_THAT(message({"rooms", 9, true}), HasSubstr("neither costs nor directions"));
  EXPECT_THAT(message({"obstacles", 100'000}), HasSubstr("cells a side from 3 to 1001"));
}

TEST(WorldFamilies, GoOnAboveTheFormerLimits) {
  for (const WorldFamily& family : world_families()) {
    const WorldSpec spec{std::string(family.name), family.grid ? 501 : 20'001};
    const World world = split_world(spec, Split::kTest, 0);
    EXPECT_EQ(find_components(world.graph(), world.blocked()).count(), 1) << spec.name();
    EXPECT_GT(world.valid_count(), 15'000) << spec.name();
  }
}

TEST(WorldFamilies, BlockTheShareAskedFor) {
  const auto make = [](std::string family, int size, double share) {
    return split_world({.family = std::move(family), .size = size, .blocked = share}, Split::kTest, 3);
  };
  const World world = make("obstacles", 100, 0.2);
  EXPECT_EQ(world.name(), "obstacles-100");
  EXPECT_EQ(find_components(world.graph(), world.blocked()).count(), 1);
  EXPECT_NEAR(world.valid_count(), 8000, 200);
  EXPECT_EQ(make("obstacles", 9, 0).valid_count(), 81);
  for (int size = 3; size < 20; ++size) EXPECT_GE(make("obstacles", size, 0.9).valid_count(), 1);
  EXPECT_THAT(error_of([&] { make("maze", 9, 0.2); }), HasSubstr("for the family obstacles: got 'maze'"));
  for (const double share : {-0.1, 0.91, static_cast<double>(NAN)}) {
    EXPECT_THAT(error_of([&] { make("obstacles", 9, share); }), HasSubstr("blocked cells: expected 0 to 0.9"));
  }
}

}  // namespace
}  // namespace graphdrl
