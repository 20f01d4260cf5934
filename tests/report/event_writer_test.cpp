#include "graphdrl/report/event_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>

#include "support.h"

namespace graphdrl {
namespace {

TEST(EventWriter, FollowsNoLinkThatHasTheNameOfItsFile) {
  const TemporaryFolder folder;
  char host[256] = "localhost";
  gethostname(host, sizeof host - 1);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto now_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
  for (int later_s = 0; later_s < 100; ++later_s) {
    const std::string name = fmt::format("events.out.tfevents.{:010}.{}.{}.0", now_s + later_s, host, getpid());
    std::filesystem::create_symlink("victim", folder / name);
  }
  const EventWriter writer(folder.path(), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "victim"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.is_symlink() ? 0 : 1;
  EXPECT_EQ(files, 1);
}

}  // namespace
}  // namespace graphdrl
