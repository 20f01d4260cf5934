#include "graphdrl/cli/command_table.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "graphdrl/cli/train_command.h"

namespace graphdrl {
namespace {

// "{4,8}" in a type's name, taken apart.
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open);
  std::vector<std::string> choices;
  if (open == std::string::npos || close == std::string::npos) return choices;
  std::size_t begin = open + 1;
  while (begin <= close) {
    const std::size_t end = std::min(type.find(',', begin), close);
    choices.push_back(type.substr(begin, end - begin));
    begin = end + 1;
  }
  return choices;
}

OptionEntry entry_of(const CLI::Option& option) {
  OptionEntry entry{.names = {},
                    .value = {},
                    .choices = {},
                    .help = option.get_description(),
                    .group = option.get_group(),
                    .required = option.get_required(),
                    .repeatable = option.get_expected_max() > 1};
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) {
    const std::string type = option.get_type_name();
    entry.choices = choices_in(type);
    entry.value = type.substr(0, type.find_first_of(":{ "));
    if (entry.value.empty()) entry.value = entry.names.empty() ? option.get_name() : "VALUE";
  }
  if (!option.get_default_str().empty()) entry.help += fmt::format(" (default: {})", option.get_default_str());
  return entry;
}

CommandEntry entry_of(const CLI::App& app, const std::string& name) {
  CommandEntry entry{.name = name, .help = app.get_description(), .options = {}, .commands = {}};
  const auto add_options = [&](const CLI::App& table) {
    for (const CLI::Option* const option : table.get_options()) entry.options.push_back(entry_of(*option));
  };
  if (name == "train") {
    visit_train_options(add_options);
  } else {
    add_options(app);
  }
  for (const CLI::App* const command : app.get_subcommands([](const CLI::App*) { return true; })) {
    entry.commands.push_back(entry_of(*command, name.empty() ? command->get_name() : name + " " + command->get_name()));
  }
  return entry;
}

}  // namespace

CommandEntry command_table(const CLI::App& program) {
  return entry_of(program, "");
}

}  // namespace graphdrl
