// `graphdrl explore --live`: an exploration that a client drives over standard input and output.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/cli/program.h"

namespace graphdrl {

struct LiveArguments {
  bool live = false;
  std::string transcript;
  bool sync = false;
  bool resume = false;
};

// What `explore` asks for beside.
struct LiveRequest {
  CoverText cover = {};
  std::string budget;
  std::string end;
  std::string score;  // empty where it was not given
  int connectivity = 8;
  std::string policy;
  std::optional<double> think_s;
  std::uint64_t seed = 1;
  std::vector<std::string> out;
};

inline constexpr const char* kWithLive = "With --live";  // the group of these options

// Adds the options that only --live has.
void add_live_options(CLI::App& command, LiveArguments& live);

// Answers line by line until the input ends.
void explore_live(const LiveArguments& arguments, const LiveRequest& request);

}  // namespace graphdrl
