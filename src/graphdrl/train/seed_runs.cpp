#include "graphdrl/train/seed_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/io/checked_json.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSeeds = 10'000;
constexpr const char* kSeedsKey = "seeds";

std::filesystem::path seeds_file(const std::filesystem::path& folder) {
  return folder / "seeds.json";
}

[[noreturn]] void refuse_seeds(const std::string& text) {
  throw Error({.what = "bad seeds",
               .expected = fmt::format("numbers and ranges as 1-8 or 1,4,7-9, {} at most", kMostSeeds),
               .got = in_quotes(text, 200),
               .where = "--seeds"});
}

// A number at the beginning of a text, which is taken off.
std::optional<std::uint64_t> take_number(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

std::vector<PlannedRun> planned_runs(const SeedsFile& file, const std::filesystem::path& folder) {
  std::vector<PlannedRun> runs;
  for (const std::uint64_t seed : file.seeds) {
    runs.push_back({.options = file.options, .directory = SeedRuns::run_directory_in(folder, seed)});
    runs.back().options.seed = seed;
  }
  return runs;
}

}  // namespace

std::vector<std::uint64_t> parse_seeds(const std::string& text) {
  std::set<std::uint64_t> seeds;
  std::string_view rest = text;
  do {
    const std::optional<std::uint64_t> first = take_number(rest);
    std::optional<std::uint64_t> last = first;
    if (rest.starts_with('-')) {
      rest.remove_prefix(1);
      last = take_number(rest);
    }
    if (!first || !last || *last < *first || *last - *first >= kMostSeeds) refuse_seeds(text);
    for (std::uint64_t i = 0; i <= *last - *first; ++i) seeds.insert(*first + i);
    if (seeds.size() > kMostSeeds || (!rest.empty() && !rest.starts_with(','))) refuse_seeds(text);
    if (rest.empty()) return {seeds.begin(), seeds.end()};
    rest.remove_prefix(1);
  } while (true);
}

SeedsFile read_seeds(const std::filesystem::path& folder) {
  const std::string source = seeds_file(folder).string();
  Json json = read_checked_json(source);
  const auto is_seed = [](const Json& seed) { return seed.is_number_unsigned(); };
  if (!json.contains(kSeedsKey) || !json[kSeedsKey].is_array() || json[kSeedsKey].empty() ||
      !std::all_of(json[kSeedsKey].begin(), json[kSeedsKey].end(), is_seed)) {
    throw Error({.what = "no list of seeds", .where = source});
  }
  auto seeds = json[kSeedsKey].get<std::vector<std::uint64_t>>();
  if (!std::is_sorted(seeds.begin(), seeds.end(), std::less_equal<>())) {
    throw Error({.what = "the seeds do not ascend", .where = source});
  }
  json.erase(kSeedsKey);
  return {.seeds = std::move(seeds), .options = parse_options(json, source)};
}

bool SeedRuns::are_in(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(seeds_file(folder), error);
}

RunDirectory SeedRuns::run_directory_in(const std::filesystem::path& folder, std::uint64_t seed) {
  return RunDirectory(folder / fmt::format("seed-{}", seed));
}

SeedRuns::SeedRuns(const SeedsFile& file, const std::filesystem::path& folder)
    : folder_(folder), trainings_(planned_runs(file, folder), folder) {}

SeedRuns SeedRuns::start(const TrainOptions& options, std::vector<std::uint64_t> seeds,
                         const std::filesystem::path& folder, const LearnerSource& learners, Ranks& ranks) {
  const SeedsFile file{.seeds = std::move(seeds), .options = options};
  Trainer::check(options, learners);
  Json json = config_json(options);
  json.erase("seed");
  json[kSeedsKey] = file.seeds;
  claim_folder(seeds_file(folder), json, ranks, [&] {
    RunDirectory(folder).require_new();
    for (const PlannedRun& run : planned_runs(file, folder)) run.directory.require_new();
  });
  return {file, folder};
}

SeedRuns SeedRuns::resume(const std::filesystem::path& folder) {
  return {read_seeds(folder), folder};
}

}  // namespace graphdrl
