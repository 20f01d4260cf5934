#include "graphdrl/train/explorer_options.h"

#include <algorithm>

#include "graphdrl/train/option_table.h"

namespace graphdrl {

void validate(const ExplorerOptions& options) {
  constexpr std::int64_t kMany = 1'000'000'000;
  check_choice("--preset", options.preset, {"explorer"});
  check_choice("--teacher", options.teacher, {"search", "double_dqn"});
  check_range<std::int64_t>("--rounds", options.rounds, 1, kMany);
  check_range<std::int64_t>("--largest", options.largest, 5, 20);
  check_range<std::int64_t>("--teacher-width", options.teacher_width, 1, 100'000);
  check_range("--ranking", options.ranking, 0.0, 1e3);
  check_range("--lead", options.lead, 0.0, 1.0);
  check_range<std::int64_t>("--walks", options.walks, 1, 1'000'000);
  check_range<std::int64_t>("--updates", options.updates, 1, 1'000'000);
  check_range<std::int64_t>("--batch-size", options.batch_size, 1, 65'536);
  check_range<std::int64_t>("--replay-capacity", options.replay_capacity, options.batch_size, 100'000'000);
  check_range("--learning-rate", options.learning_rate, 0.0, 1e3);
  check_range<std::int64_t>("--checkpoint-every", options.checkpoint_every, 1, kMany);
}

std::vector<WorldSpec> training_worlds(const ExplorerOptions& options) {
  const int largest = static_cast<int>(options.largest);
  std::vector<WorldSpec> worlds;
  // Most are small: there the beam's values are nearly exact, and several lessons cost as much as one of a large world.
  for (const int side : {4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 16, 20}) {
    if (side > largest) break;
    for (int copy = 0; copy < (side == 5 ? 5 : 1); ++copy) worlds.push_back({"obstacles", side});
    worlds.push_back({"rooms", side});
    if (side % 2 == 0) continue;
    for (const char* const family : {"maze", "loop-maze", "braided-maze"}) {
      for (int copy = 0; copy < (side >= 7 && side <= 11 ? 3 : 1); ++copy) worlds.push_back({family, side});
    }
  }
  for (const char* const family : {"tree", "erdos-renyi", "barabasi-albert", "watts-strogatz", "geometric"}) {
    for (const int nodes : {16, 33, 55, 77, 110, 140}) {
      if (nodes > 7 * largest) break;
      worlds.push_back({family, nodes});
      worlds.push_back({family, nodes, /*weighted=*/true});
      if (family == std::string("tree")) continue;  // one way only, a tree is soon left for good
      if (nodes > 77) continue;                     // the larger, the more of it is lost after a few steps
      worlds.push_back({family, nodes, /*weighted=*/false, /*directed=*/true});
      if (nodes <= 33) worlds.push_back({family, nodes, /*weighted=*/true, /*directed=*/true});
    }
  }
  return worlds;
}

void write_config(const std::filesystem::path& path, const ExplorerOptions& options) {
  OptionWriter writer;
  for_each_explorer_field(options, writer);
  writer.write(path);
}

ExplorerOptions read_explorer_config(const std::filesystem::path& path) {
  OptionReader reader(path);
  ExplorerOptions options;
  for_each_explorer_field(options, reader);
  reader.finish();
  validate(options);
  return options;
}

}  // namespace graphdrl
