#include "graphdrl/report/metrics_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(MetricsFile, DropsWhatComesAfterTheCheckpointItResumesFrom) {
  const TemporaryFolder folder;
  const std::vector<Scalar> scalars = {{"epsilon", 0.5}, {"loss", NAN}, {"reward", -1}};
  {
    MetricsFile file(folder / "m", "episode", 0);
    file.write(10, scalars);
  }
  const std::string first = read_file(folder / "m");
  EXPECT_EQ(first, "{\"episode\":10,\"epsilon\":0.5,\"loss\":null,\"reward\":-1.0}\n");
  {
    MetricsFile file(folder / "m", "episode", 10);
    file.write(20, scalars);
  }
  EXPECT_TRUE(read_file(folder / "m").starts_with(first));
  write_file(folder / "m", read_file(folder / "m") + "{\"episode\":30,\"st");  // a line cut short by a crash
  { MetricsFile file(folder / "m", "episode", 15); }
  EXPECT_EQ(read_file(folder / "m"), first);
}

TEST(MetricsFile, DropsLinesNestedTooDeeply) {
  const TemporaryFolder folder;
  const std::string first = "{\"episode\":1}\n";
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  write_file(folder / "m", first + "{\"episode\":2,\"loss\":" + deep + "}\n{\"episode\":3}\n");
  { MetricsFile file(folder / "m", "episode", 9); }
  EXPECT_EQ(read_file(folder / "m"), first);
}

}  // namespace
}  // namespace graphdrl
