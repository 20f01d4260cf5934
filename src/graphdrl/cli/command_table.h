// All commands with their options, as data: for completions and manual pages.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace graphdrl {

struct OptionEntry {
  std::vector<std::string> names;    // "-o", "--out"; empty for a positional
  std::string value;                 // what a value is called: "FILE"; empty for a flag
  std::vector<std::string> choices;  // all values that are allowed, if they are few
  std::string help;
  std::string group;
  bool required = false;
  bool repeatable = false;

  bool is_flag() const { return value.empty(); }
  bool is_positional() const { return names.empty(); }
};

struct CommandEntry {
  std::string name;  // "maps info"; empty for the program
  std::string help;
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;
};

// The parser of the program, with the options of `train`, which parses its own.
CommandEntry command_table(const CLI::App& program);

// The program, then every command, each before its own.
template <typename Visit>
void for_each_command(const CommandEntry& entry, const Visit& visit) {
  visit(entry);
  for (const CommandEntry& command : entry.commands) for_each_command(command, visit);
}

// The texts made from it.
std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);
std::string fish_completion(const CommandEntry& program);
// Of one of the program's commands, in man's macros for roff.
std::string manual_page(const CommandEntry& program, const CommandEntry& entry);
// "graphdrl-maps-info" of "maps info".
std::string page_name(const std::string& command);

}  // namespace graphdrl
