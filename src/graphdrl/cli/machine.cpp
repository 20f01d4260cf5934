#include "graphdrl/cli/machine.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/program.h"

namespace graphdrl {
namespace {

constexpr const char* kOutOfMemory = "out of memory";
constexpr const char* kExpectedMore = ": expected a larger --memory-limit, got ";

const char* named_program = "graphdrl";
std::array<char, 24> limit_text = {};  // as it was given; empty without a limit
rlimit limit_before = {};
std::terminate_handler end_as_before = nullptr;

// Bytes of a text such as 500M or 1.5G, in powers of 1024; empty where it is none.
std::optional<double> bytes_of(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  double scale = 1;
  if (text.ends_with("iB")) text.remove_suffix(2);
  if (const std::size_t unit = text.empty() ? kUnits.npos : kUnits.find(text.back()); unit != kUnits.npos) {
    scale = std::pow(1024.0, static_cast<double>(unit + 1));
    text.remove_suffix(1);
  }
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size()) return std::nullopt;
  value *= scale;
  return value >= 1 && value < 0x1p62 ? std::optional(value) : std::nullopt;
}

std::string check_size(const std::string& text) {
  if (bytes_of(text) && text.size() < limit_text.size()) return {};
  return fmt::format("expected a size such as 500M or 2G, got {}", in_quotes(text));
}

// What counts for RLIMIT_DATA so far, in bytes; 0 where Linux does not say.
double data_so_far() {
  constexpr int kData = 5;  // its place in statm(5)
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  for (int i = 0; i <= kData; ++i) statm >> pages;
  return statm ? pages * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0;
}

// Limits memory that may be written and is shared with nobody, whether it is touched or not [setrlimit(2),
// RLIMIT_DATA]. Not the address space: threads reserve far more of it than they use. Nor what lies in memory, which
// Linux cannot limit for one process. What is there before does not count: OpenBLAS, which CLP brings, reserves 256 MB
// that nobody touches.
void limit_memory(const std::string& text) {
  getrlimit(RLIMIT_DATA, &limit_before);
  rlimit limit = limit_before;  // a shell's own may be lower
  limit.rlim_cur = std::min(limit.rlim_cur, static_cast<rlim_t>(data_so_far() + bytes_of(text).value_or(0)));
  if (setrlimit(RLIMIT_DATA, &limit) != 0) {
    throw MachineError(
        {.what = std::string("cannot limit memory (") + std::strerror(errno) + ")", .where = "--memory-limit"});
  }
  std::copy_n(text.c_str(), text.size() + 1, limit_text.begin());
}

// Writes texts to standard error without allocating.
template <typename... Texts>
void say(const Texts*... texts) noexcept {
  (std::fputs(texts, stderr), ...);
}

[[noreturn]] void end_program() {
  if (std::current_exception() != nullptr) {
    try {
      throw;
    } catch (const std::bad_alloc&) {
      say_out_of_memory();
      _exit(kExitMachine);
    } catch (const MachineError& error) {
      say(named_program, ": ", error.what(), "\n");
      _exit(kExitMachine);
    } catch (const std::system_error& error) {
      if (is_refusal(error)) {
        say(named_program, ": the machine refused a thread or memory (", error.what(), ")\n");
        _exit(kExitMachine);
      }
    } catch (...) {
    }
  }
  end_as_before();
  std::abort();
}

}  // namespace

void add_memory_limit_option(CLI::App& command) {
  command
      .add_option_function<std::string>(
          "--memory-limit", limit_memory,
          "What the command may allocate, as 500M or 2G: past it the command ends with status 3 (default: no limit)")
      ->check(CLI::Validator(check_size, ""))
      ->type_name("SIZE");
}

void lift_memory_limit() {
  if (limit_text.front() != 0) setrlimit(RLIMIT_DATA, &limit_before);
}

void say_out_of_memory() noexcept {
  say(named_program, ": ", kOutOfMemory);
  if (limit_text.front() != 0) say(kExpectedMore, limit_text.data());
  say("\n");
}

std::string with_memory_limit(std::string complaint) {
  if (limit_text.front() == 0 || !complaint.starts_with(kOutOfMemory)) return complaint;
  return complaint.insert(std::strlen(kOutOfMemory), std::string(kExpectedMore) + limit_text.data());
}

bool is_refusal(const std::system_error& error) {
  return error.code() == std::errc::resource_unavailable_try_again || error.code() == std::errc::not_enough_memory;
}

void end_well_without_memory(const char* program) {
  named_program = program;
  if (end_as_before == nullptr) end_as_before = std::set_terminate(end_program);
}

}  // namespace graphdrl
