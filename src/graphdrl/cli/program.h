// What both programs share: exit statuses, common options, JSON output.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/base/ranks.h"
#include "graphdrl/io/any_map.h"
#include "graphdrl/io/task_folder.h"

namespace graphdrl {

using Json = nlohmann::ordered_json;

inline constexpr int kExitDone = 0;
inline constexpr int kExitOurFault = 1;
inline constexpr int kExitBadInput = 2;
inline constexpr int kExitMachine = 3;       // the machine refused: disk, memory, threads
inline constexpr int kExitRankLost = -1;     // another rank has failed, and says so
inline constexpr int kExitClosedPipe = 141;  // as a shell says of a program that SIGPIPE ended

inline constexpr int kMostPort = 65535;  // of TCP

// Parses the arguments, which runs the chosen command's callback; gives the exit status.
int run_program(CLI::App& app, int argc, char** argv);

// How complaints begin from now on. run_program() does it.
void name_program(const std::string& name);

// What the last complaint was; empty where there was none.
const std::string& last_complaint();

// Does the work; gives the exit status. Turns any exception into one line on standard error.
int attempt(const std::function<void()>& work);

// Attempts all parts, in their order. Throws CLI::RuntimeError with the gravest status where one failed.
void attempt_all(const std::vector<std::function<void()>>& parts);

// Refuses an empty text.
CLI::Validator not_empty();

// Adds --threads and has parallel_for use that many; the default is one per processor.
void add_threads_option(CLI::App& command);

// Adds the options that say how maps are read; notes go to standard error.
void add_map_options(CLI::App& command, MapOptions& options);

// What counts, as users say it.
struct CoverText {
  std::string cover = "nodes";
  std::optional<double> reset_cost = {};  // where edges count
};

// Which of many tasks a process does, as users say it.
struct ShareText {
  std::string task;
  bool merge = false;

  // None of those to be merged. Throws Error on a bad share.
  TaskShare share() const { return merge ? TaskShare::none() : task.empty() ? TaskShare() : parse_task_share(task); }
};

// Says that a share of --task is done.
void print_share_done(const TaskShare& share);

// Adds --task and --merge.
void add_share_options(CLI::App& command, ShareText& text);

// The options given, but for these, a line each.
std::string given_options(const CLI::App& command, const std::vector<std::string>& but_for);

// Checksums of the files behind maps and policies, by their names; of what is no file there is none.
Json checksums_of(const std::vector<std::string>& maps, const std::vector<std::string>& others);

// Ends with status 2 where tasks of a folder were left out, which were named.
void require_none_left_out(const TaskFolder& folder);

// Adds --cover and --reset-cost.
void add_cover_options(CLI::App& command, CoverText& text);

// Adds an option or an argument that takes a text, called `type` in help, and refuses an empty one, such as that of an
// unset variable.
template <typename T>
CLI::Option* add_text_option(CLI::App& command, const std::string& names, T& value, const std::string& type,
                             const std::string& help) {
  return command.add_option(names, value, help)->check(not_empty())->type_name(type);
}

// Adds --seed, a whole number from 0 to 2^64 - 1; `help` says what it is for.
CLI::Option* add_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& help);

// Accepts whole numbers from 0 to 2^64 - 1.
CLI::Validator whole_number();

// One JSON document on standard output, over several lines. Arrays of numbers, and arrays of such arrays, take one line
// each.
void print_json(const Json& json);

// Text on standard error; lost if that is closed.
void print_diagnostic(const std::string& text);

// Text on standard output. Throws MachineError if it cannot be written, as on a full disk. If its reader is gone,
// throws CLI::RuntimeError, which ends the program with kExitClosedPipe and no word.
void print_text(const std::string& text);

// A value or null.
template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace graphdrl
