// What a power cut leaves of plans and pages: the old file or the new one, and the new one once it is reported.
#include <gtest/gtest.h>

#include <functional>

#include "graphdrl/io/file.h"
#include "graphdrl/report/plan_files.h"
#include "graphdrl/report/report_page.h"
#include "logged_disk.h"
#include "support.h"

namespace graphdrl {
namespace {

Answer answer_along(std::vector<NodeId> walk) {
  const World world = grid_world("...\n");
  const Task task(world, walk.front(), 4);
  return {.world = world, .task = task, .policy = "mine", .plan = plan_of_walk(task, std::move(walk))};
}

// Writes an old file and a new one in its place. Cuts the power at every event.
void expect_old_or_new(const std::function<void(const std::string& file, const Answer& answer)>& write) {
  const TemporaryFolder folder;
  const std::filesystem::path cut = folder / "cut";
  std::filesystem::create_directory(cut);
  const std::filesystem::path file = cut / "file.json";
  const LoggedDisk disk;
  write(file.string(), answer_along({0, 1}));
  const std::size_t old_saved = disk.events();
  const std::string old_content = read_file(file);
  write(file.string(), answer_along({0, 1, 2}));
  const std::string new_content = read_file(file);
  set_file_system(nullptr);
  EXPECT_NE(old_content, new_content);
  Rng rng(1);
  for (std::size_t events = 0; events <= disk.events(); ++events) {
    for (int variant = 0; variant < 20; ++variant) {
      disk.cut(events, cut, rng);
      if (events < old_saved && !std::filesystem::exists(file)) continue;
      const std::string found = read_file(file);
      EXPECT_TRUE(found == new_content || (events < disk.events() && found == old_content)) << events;
      EXPECT_TRUE(found == old_content || events > old_saved) << events;
    }
  }
}

TEST(PowerCut, LeavesAPlanWhole) {
  expect_old_or_new([](const std::string& file, const Answer& answer) { write_plan(answer, file); });
}

TEST(PowerCut, LeavesAReportPageWhole) {
  expect_old_or_new([](const std::string& file, const Answer& answer) {
    ReportPage page("Mine");
    page.add_plan(answer);
    write_file(file, page.html());
  });
}

}  // namespace
}  // namespace graphdrl
