#include "graphdrl/io/node_ids.h"

#include <gmock/gmock.h>

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

TEST(NodeIds, TakeNoLabelsWhileTheyCount) {
  NodeIds ids;
  EXPECT_TRUE(ids.add("0"));
  EXPECT_TRUE(ids.add("1"));
  EXPECT_FALSE(ids.add("0"));
  EXPECT_FALSE(ids.add("1"));
  EXPECT_EQ(ids.find("1"), 1);
  EXPECT_EQ(ids.find("2"), kNoNode);
  EXPECT_EQ(ids.find("01"), kNoNode);
  EXPECT_EQ(ids.find(""), kNoNode);
  EXPECT_EQ(ids.count(), 2);
  EXPECT_TRUE(ids.take_labels().empty());
}

TEST(NodeIds, NumbersAndTheirDigitsAreTheSame) {
  NodeIds ids;
  EXPECT_TRUE(ids.add("0"));
  EXPECT_TRUE(ids.add("dock"));  // spells out what came before
  EXPECT_TRUE(ids.add("18446744073709551615"));
  EXPECT_TRUE(ids.add("00"));
  EXPECT_TRUE(ids.add("-0"));
  EXPECT_FALSE(ids.add("18446744073709551615"));
  EXPECT_FALSE(ids.add("0"));
  EXPECT_EQ(ids.find("0"), 0);
  EXPECT_EQ(ids.find("1"), kNoNode);
  EXPECT_EQ(ids.find("dock"), 1);
  EXPECT_EQ(ids.find("18446744073709551615"), 2);
  EXPECT_THAT(ids.take_labels(), ElementsAre("0", "dock", "18446744073709551615", "00", "-0"));
}

}  // namespace
}  // namespace graphdrl
