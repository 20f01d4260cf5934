#include "graphdrl/cli/program.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl {
namespace {

constexpr std::size_t kLongestMessage = 800;  // characters: CLI11's repeat a bad line however long it is

int complain(const CLI::App& app, std::string_view message, int status) {
  message = message.substr(0, message.find('\n'));
  const char* const rest = message.size() > kLongestMessage ? " …" : "";
  print_diagnostic(fmt::format("{}: {}{}\n", app.get_name(), escaped(message.substr(0, kLongestMessage)), rest));
  return status;
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

void print_json(const Json& json) {
  print_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace graphdrl
