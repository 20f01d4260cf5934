#include "graphdrl/cli/plan_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/stop_signals.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/report/plan_files.h"
#include "graphdrl/report/progress.h"

namespace graphdrl {
namespace {

// A map of many, and where its plan goes.
struct PlannedMap {
  std::string source;
  std::string name;  // of the file, without its ending; whole where several would have the same
};

std::vector<PlannedMap> planned_maps(const std::string& source) {
  std::vector<PlannedMap> maps;
  std::map<std::string, int> uses;
  for (const std::string& one : map_sources(source)) {
    std::string name = std::filesystem::path(one).filename().stem().string();
    if (source == "paper") std::ranges::replace(name, ':', '-');
    ++uses[name];
    maps.push_back({.source = one, .name = std::move(name)});
  }
  std::set<std::string> names;
  for (PlannedMap& map : maps) {
    if (uses[map.name] > 1) map.name = std::filesystem::path(map.source).filename().string();
    if (names.insert(map.name).second) continue;
    throw Error({.what = "two plans would have the name " + map.name, .where = map.source});
  }
  return maps;
}

// A line of the summary; nothing where the plan is lacking.
std::optional<Json> summary_of(const PlannedMap& map, const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  const nlohmann::json plan = parse_json(read_file(file), file.string());
  Json line = {{"map", map.name}};
  for (const char* const key :
       {"policy", "budget", "visited", "coverage", "prize", "cost", "upper_bound", "gap", "optimal"}) {
    line[key] = plan.value(key, nlohmann::json());
  }
  return line;
}

std::string to_csv(const Json& summary) {
  std::string text;
  for (const Json& line : summary) {
    if (text.empty()) {
      std::vector<std::string> keys;
      for (const auto& item : line.items()) keys.push_back(item.key());
      text += fmt::format("{}\n", fmt::join(keys, ","));
    }
    std::vector<std::string> fields;
    for (const Json& value : line) {
      fields.push_back(value.is_null() ? "" : value.is_string() ? csv_field(value.get<std::string>()) : value.dump());
    }
    text += fmt::format("{}\n", fmt::join(fields, ","));
  }
  return text;
}

// Writes FOLDER/summary.csv of the plans that are there, and gives it; says how many are not.
Json summarise_plans(const std::vector<PlannedMap>& maps, const std::filesystem::path& folder) {
  Json summary = Json::array();
  for (const PlannedMap& map : maps) {
    if (auto line = summary_of(map, folder / (map.name + ".json"))) summary.push_back(std::move(*line));
  }
  write_file(folder / "summary.csv", to_csv(summary));
  return summary;
}

bool is_planned(const PlannedMap& map, const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(folder / (map.name + ".json"), error);
}

// Makes sure that the plans in the folder are of the same options and files.
void claim_plans(const FolderOfPlans& plans, const std::vector<PlannedMap>& maps, const CLI::App& command) {
  const std::vector<std::string> free = {"--out",          "--task", "--merge", "--threads",
                                         "--memory-limit", "--json", "--walk"};
  const Json origin = {{"options", given_options(command, free)}, {"files", checksums_of({plans.maps}, plans.files)}};
  plans.workers.ranks.require_same("files", origin.dump(-1, ' ', false, Json::error_handler_t::replace));
  claim_folder(plans.folder / ".plans.json", origin, plans.workers.ranks, [&] {
    if (std::ranges::none_of(maps, [&](const PlannedMap& map) { return is_planned(map, plans.folder); })) return;
    throw Error({.what = "the folder holds files of the plans' names",
                 .expected = "a new one",
                 .where = plans.folder.string()});
  });
}

// Gives whether all of the share is done.
bool plan_missing(const FolderOfPlans& plans, const std::vector<PlannedMap>& maps,
                  const std::function<Answer(const std::string& map)>& answer) {
  std::vector<TaskFolder::Task> tasks;
  std::int64_t to_do = 0;
  for (const PlannedMap& map : maps) {
    const bool own = plans.workers.share.has(static_cast<int>(tasks.size()));
    tasks.push_back({.name = map.name, .done = is_planned(map, plans.folder)});
    if (own && !tasks.back().done) ++to_do;
  }
  ProgressDisplay display("map");
  std::mutex mutex;
  std::int64_t done = 0;
  const auto stop = [] { return stop_flag().load(); };
  return TaskFolder(plans.folder).run(tasks, plans.workers, stop, [&](int task) {
    const Answer planned = answer(maps[task].source);
    if (stop()) return false;
    write_plan(planned, (plans.folder / (maps[task].name + ".json")).string());
    const std::lock_guard lock(mutex);
    ++done;
    display.show(done, to_do, maps[task].name, done == to_do);
    return true;
  });
}

}  // namespace

bool asks_for_folder(const std::string& maps, const std::filesystem::path& out) {
  std::error_code error;
  if (maps != "paper" && !std::filesystem::is_directory(maps, error)) return false;
  return std::filesystem::is_directory(out, error) || !out.has_extension();
}

void plan_folder(const FolderOfPlans& plans, const CLI::App& command,
                 const std::function<Answer(const std::string& map)>& answer) {
  const TaskWorkers& workers = plans.workers;
  const std::vector<PlannedMap> maps = planned_maps(plans.maps);
  claim_plans(plans, maps, command);
  catch_stop_signals();
  std::exception_ptr failure;
  bool finished = true;
  try {
    finished = plan_missing(plans, maps, answer);
  } catch (...) {
    failure = std::current_exception();
  }
  const bool whole = workers.share.all() || workers.share.is_none();
  const Json summary = whole && workers.ranks.is_first() ? summarise_plans(maps, plans.folder) : Json();
  if (failure) std::rethrow_exception(failure);
  if (!finished) {
    print_diagnostic("Stopped; the plans made so far are kept. To go on: the same command\n");
    throw CLI::RuntimeError(128 + stop_signal());
  }
  if (!whole) return print_share_done(workers.share);
  if (!workers.ranks.is_first()) return;
  if (plans.json) {
    print_json({{"plans", summary}});
  } else {
    print_text(fmt::format("Planned {} of {} maps; all in one table: {}\n", summary.size(), maps.size(),
                           escaped((plans.folder / "summary.csv").string())));
  }
  if (summary.size() < maps.size()) throw CLI::RuntimeError(kExitBadInput);
}

}  // namespace graphdrl
