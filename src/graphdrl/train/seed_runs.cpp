#include "graphdrl/train/seed_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"

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
  const std::string text = read_file(source);
  require_shallow_json(text, source);
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto is_seed = [](const Json& seed) { return seed.is_number_unsigned(); };
  if (!json.is_object() || !json.contains(kSeedsKey) || !json[kSeedsKey].is_array() || json[kSeedsKey].empty() ||
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

const TrainingProgress& SeedRuns::progress(std::uint64_t seed) const {
  return progress_[static_cast<std::size_t>(std::lower_bound(seeds_.begin(), seeds_.end(), seed) - seeds_.begin())];
}

SeedRuns SeedRuns::start(const TrainOptions& options, std::vector<std::uint64_t> seeds, std::filesystem::path folder,
                         const MakePaperLearner& make_learner) {
  if (are_in(folder)) {
    throw Error({.what = "the folder holds runs already",
                 .expected = "a new folder, or --resume to go on with them",
                 .where = folder.string()});
  }
  SeedRuns runs(options, std::move(seeds), std::move(folder), make_learner);
  // The first one is begun before anything is written: it refuses what all would.
  runs.options_.seed = runs.seeds_.front();
  Trainer::start(runs.options_, runs.run_directory(runs.seeds_.front()), make_learner);
  Json json = config_json(runs.options_);
  json.erase("seed");
  json[kSeedsKey] = runs.seeds_;
  write_file(seeds_file(runs.folder_), json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
  runs.begin();
  return runs;
}

SeedRuns SeedRuns::resume(std::filesystem::path folder, const MakePaperLearner& make_learner) {
  SeedsFile file = read_seeds(folder);
  SeedRuns runs(std::move(file.options), std::move(file.seeds), std::move(folder), make_learner);
  runs.begin();
  return runs;
}

void SeedRuns::begin() {
  for (std::size_t i = 0; i < seeds_.size(); ++i) {
    const RunDirectory run = run_directory(seeds_[i]);
    options_.seed = seeds_[i];
    const bool there = std::filesystem::exists(run.checkpoint());
    const auto trainer = there ? Trainer::resume(run, make_learner_) : Trainer::start(options_, run, make_learner_);
    progress_[i] = trainer->progress();
    units_ = trainer->units();
  }
}

bool SeedRuns::run(const std::function<bool()>& stop, const std::function<void(const SeedRunsNews&)>& tell) {
  const auto start = std::chrono::steady_clock::now();
  const auto sum = [&](auto member) {
    std::int64_t all = 0;
    for (const TrainingProgress& progress : progress_) all += progress.*member;
    return all;
  };
  const auto trained = [&](const TrainingProgress& progress) { return progress.done == units_.count; };
  const std::int64_t samples_before = sum(&TrainingProgress::samples);
  std::mutex mutex;
  const auto note = [&](std::size_t i, const TrainingProgress& progress) {
    const std::lock_guard lock(mutex);
    progress_[i] = progress;
    const double session_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::int64_t samples = sum(&TrainingProgress::samples) - samples_before;
    tell({.seeds_done = static_cast<int>(std::count_if(progress_.begin(), progress_.end(), trained)),
          .units_done = sum(&TrainingProgress::done),
          .units = units_.count * std::ssize(seeds_),
          .samples_per_s = static_cast<double>(samples) / std::max(session_s, 1e-9)});
  };
  // Another device has one training at a time.
  const bool side_by_side = options_.device.empty() || options_.device == "cpu";
  const auto train = [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    if (trained(progress_[index]) || stop()) return;
    try {
      const auto trainer = Trainer::resume(run_directory(seeds_[index]), make_learner_);
      trainer->run(stop, [&](const TrainingNews& news) { note(index, news.progress); });
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("seed {}: {}", seeds_[index], error.what()));
    }
  };
  const int count = static_cast<int>(seeds_.size());
  if (side_by_side) {
    parallel_for(count, train);
  } else {
    for (int i = 0; i < count; ++i) train(i);
  }
  return std::all_of(progress_.begin(), progress_.end(), trained);
}

}  // namespace graphdrl
