#include "graphdrl/report/metrics_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(MetricsFile, DropsWhatComesAfterTheCheckpointItResumesFrom) {
  const TemporaryFolder folder;
  const MetricsLine line{
      .episode = 10, .steps = 250, .epsilon = 0.5, .loss = NAN, .visited_nodes = 9.5, .coverage = 50, .reward = -1};
  {
    MetricsFile file(folder / "m", 0);
    file.write(line);
  }
  const std::string first = read_file(folder / "m");
  EXPECT_EQ(first,
            "{\"episode\":10,\"steps\":250,\"epsilon\":0.5,\"loss\":null,\"visited_nodes\":9.5,\"coverage\":50.0,"
            "\"reward\":-1.0}\n");
  MetricsLine second = line;
  second.episode = 20;
  {
    MetricsFile file(folder / "m", 10);
    file.write(second);
  }
  EXPECT_TRUE(read_file(folder / "m").starts_with(first));
  write_file(folder / "m", read_file(folder / "m") + "{\"episode\":30,\"st");  // a line cut short by a crash
  { MetricsFile file(folder / "m", 15); }
  EXPECT_EQ(read_file(folder / "m"), first);
}

}  // namespace
}  // namespace graphdrl
