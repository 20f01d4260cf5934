#include "graphdrl/train/run_directory.h"

#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/checked_json.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

RunRecord read_record(const RunDirectory& run) {
  const Json json = read_checked_json(run.record());
  try {
    RunRecord record{
        .finished = json.at("finished"),
        .progress = {.done = json.at("done"), .samples = json.at("samples"), .elapsed_s = json.at("elapsed_s")},
        .files = {}};
    for (const auto& [name, sum] : json.at("files").items()) {
      if (std::filesystem::path(name).filename() != name) continue;  // of another folder
      record.files[name] = {.bytes = sum.at("bytes"), .sum = sum.at(kChecksumKey)};
    }
    return record;
  } catch (const Json::exception&) {
    throw Error({.what = "not the record of a run", .where = run.record().string()});
  }
}

}  // namespace

bool RunDirectory::holds_a_run() const {
  std::error_code error;
  for (const auto& file : {config(), metrics(), policy(), checkpoint(), previous_checkpoint(), record()}) {
    if (std::filesystem::exists(file, error)) return true;
  }
  return false;
}

void RunDirectory::require_new() const {
  if (!holds_a_run()) return;
  throw Error({.what = "the folder holds a run already",
               .expected = "a new folder, or --resume to go on with that run",
               .where = path_.string()});
}

FileSum FileSum::of(std::string_view content) {
  return {.bytes = content.size(), .sum = checksum({content})};
}

void RunRecord::add(const std::filesystem::path& file, std::string_view content) {
  files[file.filename().string()] = FileSum::of(content);
}

void write_record(const RunDirectory& run, const RunRecord& record) {
  Json files = Json::object();
  for (const auto& [name, sum] : record.files) files[name] = {{"bytes", sum.bytes}, {kChecksumKey, sum.sum}};
  write_checked_json(run.record(), {{"finished", record.finished},
                                    {"done", record.progress.done},
                                    {"samples", record.progress.samples},
                                    {"elapsed_s", record.progress.elapsed_s},
                                    {"files", files}});
}

bool RunState::is_whole(const std::filesystem::path& file) const {
  if (!record) return false;
  const auto sum = record->files.find(file.filename().string());
  if (sum == record->files.end()) return false;
  try {
    return FileSum::of(read_file(file)) == sum->second;
  } catch (const MachineError&) {
    throw;
  } catch (const Error&) {
    return false;
  }
}

RunState state_of(const RunDirectory& run) {
  RunState state;
  std::error_code error;
  if (!std::filesystem::exists(run.record(), error)) {
    state.faults.emplace_back("run.json is missing");
    return state;
  }
  try {
    state.record = read_record(run);
  } catch (const MachineError&) {
    throw;
  } catch (const Error&) {
    state.faults.emplace_back("run.json is damaged");
    return state;
  }
  for (const auto& [name, sum] : state.record->files) {
    const std::filesystem::path file = run.path() / name;
    if (state.is_whole(file)) continue;
    state.faults.push_back(name + (std::filesystem::exists(file, error) ? " is not as run.json says" : " is missing"));
  }
  return state;
}

}  // namespace graphdrl
