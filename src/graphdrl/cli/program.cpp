#include "graphdrl/cli/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <system_error>

#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/base/ranks.h"
#include "graphdrl/cli/machine.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/io/text.h"
#include "graphdrl/report/progress.h"

namespace graphdrl {
namespace {

constexpr std::size_t kLongestMessage = 800;  // characters: messages of CLI11 repeat a bad line, long or short
constexpr int kJsonIndent = 2;
constexpr double kQuietS = 1;  // before a bar shows how much of a map is read

std::string program_name;
std::string complaint;
constexpr const char* kShortOfMemory = "out of memory\n";  // nothing is allocated for so few characters

int complain(std::string_view message, int status) {
  message = message.substr(0, message.find('\n'));
  const char* const rest = message.size() > kLongestMessage ? " …" : "";
  complaint = fmt::format("{}: {}{}\n", program_name, escaped(message.substr(0, kLongestMessage)), rest);
  print_diagnostic(complaint);
  return status;
}

// Numbers, or arrays of them in any depth.
bool is_numbers(const Json& json) {
  return json.is_array() &&
         std::all_of(json.begin(), json.end(), [](const Json& item) { return item.is_number() || is_numbers(item); });
}

// The JSON library leaves the second set of control characters as they are, which some terminals obey.
std::string json_line(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find('\xC2', at)) != text.npos; ++at) {
    const auto code = static_cast<unsigned char>(text[at + 1]);
    if (code < 0xA0) text.replace(at, 2, fmt::format("\\u{:04x}", code));
  }
  return text;
}

void append_json(const Json& json, int indent, std::string& text) {
  if (json.empty() || !json.is_structured()) {
    text += json_line(json);
    return;
  }
  if (is_numbers(json)) {
    for (const char c : json.dump()) {
      text += c;
      if (c == ',') text += ' ';
    }
    return;
  }
  const auto start_line = [&](int columns) { text.append(1, '\n').append(static_cast<std::size_t>(columns), ' '); };
  text += json.is_object() ? '{' : '[';
  for (auto item = json.begin(); item != json.end(); ++item) {
    if (item != json.begin()) text += ',';
    start_line(indent + kJsonIndent);
    if (json.is_object()) text += json_line(item.key()) + ": ";
    append_json(*item, indent + kJsonIndent, text);
  }
  start_line(indent);
  text += json.is_object() ? '}' : ']';
}

// Runs the command asked for, or prints the help or the version that is.
void parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    // The help of the command asked about, not of the whole program.
    const CLI::App* asked = &app;
    std::string parents;
    while (!asked->get_subcommands().empty()) {
      parents += (parents.empty() ? "" : " ") + asked->get_name();
      asked = asked->get_subcommands().front();
    }
    print_text(asked->help(parents));
  } catch (const CLI::CallForVersion& call) {
    print_text(fmt::format("{}\n", call.what()));
  }
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // writing to a closed pipe fails like any other write
  std::signal(SIGXFSZ, SIG_IGN);  // and so does writing past the limit on the size of files
  set_threads(hardware_threads());
  listen_to_notes([](const std::string& text) { print_diagnostic(escaped(text) + "\n"); });
  name_program(app.get_name());
  end_well_without_memory(program_name.c_str());
  return attempt([&] { parse(app, argc, argv); });
}

void name_program(const std::string& name) {
  program_name = name;
}

const std::string& last_complaint() {
  return complaint;
}

int attempt(const std::function<void()>& work) {
  try {
    work();
    return kExitDone;
  } catch (const RankLost&) {
    return kExitRankLost;
  } catch (const CLI::RuntimeError& error) {  // a command that chose its own status
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return complain(error.what(), kExitBadInput);
  } catch (const MachineError& error) {
    return complain(with_memory_limit(error.what()), kExitMachine);
  } catch (const Error& error) {
    return complain(error.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    say_out_of_memory();
    complaint = kShortOfMemory;
    return kExitMachine;
  } catch (const std::filesystem::filesystem_error& error) {
    return complain(fmt::format("{} ({})", error.path1().string(), error.code().message()), kExitBadInput);
  } catch (const std::system_error& error) {
    if (!is_refusal(error)) return complain(error.what(), kExitOurFault);
    return complain(fmt::format("the machine refused a thread or memory ({})", error.what()), kExitMachine);
  } catch (const std::exception& error) {
    return complain(error.what(), kExitOurFault);
  }
}

void attempt_all(const std::vector<std::function<void()>>& parts) {
  const auto gravity = [](int status) { return status == kExitClosedPipe ? 0.5 : status; };
  int gravest = kExitDone;
  for (const auto& part : parts) {
    const int status = attempt(part);
    if (gravity(status) > gravity(gravest)) gravest = status;
  }
  if (gravest != kExitDone) throw CLI::RuntimeError(gravest);
}

void add_threads_option(CLI::App& command) {
  command
      .add_option_function<int>(
          "--threads", [](int count) { set_threads(count); },
          "Threads to use; results do not depend on it (default: one per processor)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void add_share_options(CLI::App& command, ShareText& text) {
  CLI::Option* const task =
      add_text_option(command, "--task", text.task, "I/N",
                      "Do the I-th of N shares of the tasks, as 3/20, for arrays of jobs; then --merge");
  command.add_flag("--merge", text.merge, "Do no task: put together what others did with --task")->excludes(task);
}

void print_share_done(const TaskShare& share) {
  print_text(fmt::format("Share {} of {} is done\n", share.index + 1, share.count));
}

std::string given_options(const CLI::App& command, const std::vector<std::string>& but_for) {
  std::string given;
  for (const CLI::Option* const option : command.get_options()) {
    if (option->count() == 0 || std::ranges::find(but_for, option->get_name()) != but_for.end()) continue;
    given += fmt::format("{} {}\n", option->get_name(), fmt::join(option->results(), " "));
  }
  return given;
}

Json checksums_of(const std::vector<std::string>& maps, const std::vector<std::string>& others) {
  Json sums = Json::object();
  const auto add = [&](const std::string& file) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) sums[file] = checksum({read_file(file)});
  };
  for (const std::string& source : maps) {
    for (const std::string& map : map_sources(source)) add(map);
  }
  for (const std::string& file : others) add(file);
  return sums;
}

void require_none_left_out(const TaskFolder& folder) {
  if (folder.left_out_count() > 0) throw CLI::RuntimeError(kExitBadInput);
}

void add_cover_options(CLI::App& command, CoverText& text) {
  command
      .add_option("--cover", text.cover,
                  "What counts: nodes, or edges walked whole, loops and parallel ones too; edges without a budget: all")
      ->check(CLI::IsMember({"nodes", "edges"}))
      ->capture_default_str();
  command
      .add_option("--reset-cost", text.reset_cost,
                  "Of --cover edges where edges lead one way: what it costs to jump back to the start")
      ->check(CLI::NonNegativeNumber)
      ->type_name("C");
}

void add_map_options(CLI::App& command, MapOptions& options) {
  options.note = [](const std::string& note) { print_diagnostic(escaped(note) + "\n"); };
  options.progress = [display = std::make_shared<std::optional<ProgressDisplay>>()](double share) {
    if (share >= 1) return display->reset();
    if (!*display) display->emplace("reading", /*first=*/0, kQuietS);
    (*display)->show_line(fmt::format("{:.0f} %", 100 * share), share);
  };
  const auto positive = [](const std::string& text) {
    const double value = parse_number(text).value_or(0);
    return value > 0 && value < 1e9 ? "" : fmt::format("expected a number above 0, got {}", in_quotes(text));
  };
  command.option_defaults()->group("Options for maps");
  add_text_option(command, "--cost-attribute", options.cost_attribute, "NAME",
                  "Of graphs: the edges' attribute that is their cost; none: each costs 1 (default: weight, cost, "
                  "length or distance)");
  add_text_option(command, "--prize-attribute", options.prize_attribute, "NAME",
                  "Of graphs: the nodes' attribute that is their prize; none: each is worth 1 (default: prize or "
                  "score)");
  command.add_flag("--directed", options.directed, "Of edge lists and TGF, which do not say it: edges lead one way");
  command
      .add_option_function<std::string>(
          "--connectivity", [&options](const std::string& count) { options.diagonals = count == "8"; },
          "Of grids: neighbours of a cell, 4 or 8; a diagonal step costs the square root of 2 (default: 4)")
      ->check(CLI::IsMember({"4", "8"}))
      ->type_name("N");
  command
      .add_flag("--cut-corners", options.cut_corners, "With --connectivity 8: diagonal steps may pass blocked cells")
      ->needs("--connectivity");
  command
      .add_option("--robot-radius", options.robot_radius,
                  "Of grids: obstacles grow by this, in the map's unit, or in cells where it has none")
      ->check(CLI::Validator(positive, ""))
      ->type_name("R");
  command
      .add_option("--cell-size", options.cell_size,
                  "Of grids that say how large their cells are: larger cells, free where all they cover is; a side, in "
                  "the unit")
      ->check(CLI::Validator(positive, ""))
      ->type_name("S");
  command.add_option("--cell-pixels", options.cell_pixels, "Of pictures: pixels a side of a cell")
      ->check(CLI::Range(1, 10'000))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--unknown", [&options](const std::string& what) { options.unknown_is_free = what == "free"; },
          "Of ROS maps: what unknown cells are, blocked or free (default: blocked)")
      ->check(CLI::IsMember({"blocked", "free"}))
      ->type_name("WHAT");
  command.option_defaults()->group("Options");
}

CLI::Option* add_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& help) {
  return command.add_option("--seed", seed, help)->check(whole_number())->capture_default_str();
}

CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && rest == end) return std::string();
    return fmt::format("expected a whole number from 0 to {}, got {}", std::numeric_limits<std::uint64_t>::max(),
                       in_quotes(text));
  };
  return CLI::Validator(check, "");
}

CLI::Validator not_empty() {
  return {[](const std::string& text) { return std::string(text.empty() ? "expected a value, got ''" : ""); }, ""};
}

void print_diagnostic(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

void print_text(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    if (errno == EPIPE) throw CLI::RuntimeError(kExitClosedPipe);
    throw MachineError({.what = std::string("cannot write to standard output (") + std::strerror(errno) + ")"});
  }
}

void print_json(const Json& json) {
  std::string text;
  append_json(json, 0, text);
  print_text(text + '\n');
}

}  // namespace graphdrl
