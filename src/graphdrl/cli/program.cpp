#include "graphdrl/cli/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <limits>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl {
namespace {

constexpr std::size_t kLongestMessage = 800;  // characters: CLI11's repeat a bad line however long it is
constexpr int kJsonIndent = 2;

int complain(const CLI::App& app, std::string_view message, int status) {
  message = message.substr(0, message.find('\n'));
  const char* const rest = message.size() > kLongestMessage ? " …" : "";
  print_diagnostic(fmt::format("{}: {}{}\n", app.get_name(), escaped(message.substr(0, kLongestMessage)), rest));
  return status;
}

// Numbers, or arrays of them in any depth.
bool is_numbers(const Json& json) {
  return json.is_array() &&
         std::all_of(json.begin(), json.end(), [](const Json& item) { return item.is_number() || is_numbers(item); });
}

void append_json(const Json& json, int indent, std::string& text) {
  if (json.empty() || !json.is_structured()) {
    text += json.dump(-1, ' ', false, Json::error_handler_t::replace);
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
    if (json.is_object()) text += Json(item.key()).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    append_json(*item, indent + kJsonIndent, text);
  }
  start_line(indent);
  text += json.is_object() ? '}' : ']';
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // writing to a closed pipe fails like any other write
  set_threads(hardware_threads());
  try {
    app.parse(argc, argv);
    return kExitDone;
  } catch (const CLI::CallForHelp&) {
    // The help of the command asked about, not of the whole program.
    const CLI::App* asked = &app;
    std::string parents;
    while (!asked->get_subcommands().empty()) {
      parents += (parents.empty() ? "" : " ") + asked->get_name();
      asked = asked->get_subcommands().front();
    }
    print_text(asked->help(parents));
    return kExitDone;
  } catch (const CLI::CallForVersion& call) {
    print_text(fmt::format("{}\n", call.what()));
    return kExitDone;
  } catch (const CLI::RuntimeError& error) {  // a command that chose its own status
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return complain(app, error.what(), kExitBadInput);
  } catch (const Error& error) {
    return complain(app, error.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    return complain(app, "out of memory", kExitOurFault);
  } catch (const std::exception& error) {
    return complain(app, error.what(), kExitOurFault);
  }
}

void add_threads_option(CLI::App& command) {
  command
      .add_option_function<int>(
          "--threads", [](int count) { set_threads(count); },
          "Threads to use; results do not depend on it (default: one per processor)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
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
  return CLI::Validator([](std::string& text) { return std::string(text.empty() ? "expected a value, got ''" : ""); },
                        "");
}

void print_diagnostic(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

void print_text(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error({.what = "cannot write to standard output"});
  }
}

std::string format_json(const Json& json) {
  std::string text;
  append_json(json, 0, text);
  return text + '\n';
}

void print_json(const Json& json) {
  print_text(format_json(json));
}

}  // namespace graphdrl
