#include "graphdrl/report/metrics_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(MetricsFile, AppendsToTheLinesSoFar) {
  const TemporaryFolder folder;
  const std::vector<Scalar> scalars = {{"epsilon", 0.5}, {"loss", NAN}, {"reward", -1}};
  const std::string first = "{\"episode\":10,\"epsilon\":0.5,\"loss\":null,\"reward\":-1.0}\n";
  {
    MetricsFile file(folder / "m", "episode", "");
    file.write(10, scalars);
    EXPECT_EQ(file.lines(), first);
  }
  EXPECT_EQ(read_file(folder / "m"), first);
  write_file(folder / "m", first + "{\"episode\":30,\"st");  // a line cut short by a crash
  MetricsFile file(folder / "m", "episode", first);
  file.write(20, scalars);
  EXPECT_TRUE(read_file(folder / "m").starts_with(first + "{\"episode\":20,"));
  EXPECT_EQ(read_file(folder / "m"), file.lines());
}

TEST(MetricsUntil, DropsWhatComesLaterAndWhatIsCutShort) {
  const TemporaryFolder folder;
  const std::string first = "{\"episode\":1}\n";
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  write_file(folder / "m", first + "{\"episode\":2,\"loss\":" + deep + "}\n{\"episode\":3}\n");
  EXPECT_EQ(metrics_until(folder / "m", "episode", 9), first);
  write_file(folder / "m", first + "{\"episode\":30}\n{\"episode\":3");
  EXPECT_EQ(metrics_until(folder / "m", "episode", 9), first);
  EXPECT_EQ(metrics_until(folder / "none", "episode", 9), "");
}

}  // namespace
}  // namespace graphdrl
