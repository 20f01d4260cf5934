#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "graphdrl/cli/command_table.h"

namespace graphdrl {
namespace {

std::string last_word(const std::string& name) {
  return name.substr(name.rfind(' ') + 1);
}

std::vector<std::string> words_of(const CommandEntry& entry) {
  std::vector<std::string> words;
  for (const CommandEntry& command : entry.commands) words.push_back(last_word(command.name));
  return words;
}

// For a shell, between single quotes.
std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Escapes brackets and colons, which mean something to zsh's _arguments.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_function(const std::string& name) {
  std::string function = "_graphdrl";
  if (!name.empty()) function += "_" + name;
  std::replace(function.begin(), function.end(), ' ', '_');
  return function;
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
  std::string known;
  std::string cases;
  for_each_command(program, [&](const CommandEntry& entry) {
    for (const CommandEntry& command : entry.commands) {
      known += fmt::format("      '{} {}') command='{}' ;;\n", entry.name, last_word(command.name), command.name);
    }
    std::vector<std::string> names;
    std::string values;
    for (const OptionEntry& option : entry.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (option.is_positional() || option.is_flag()) continue;
      const std::string what =
          option.choices.empty() ? "values=files" : shell_quoted(fmt::format("{}", fmt::join(option.choices, " ")));
      values += fmt::format("        {}) {} ;;\n", fmt::join(option.names, "|"),
                            option.choices.empty() ? what : "values=" + what);
    }
    const std::string words = shell_quoted(fmt::format("{}", fmt::join(words_of(entry), " ")));
    const std::string options = shell_quoted(fmt::format("{}", fmt::join(names, " ")));
    cases += fmt::format("    {})\n      words={} options={}\n", shell_quoted(entry.name), words, options);
    if (!values.empty()) cases += fmt::format("      case $previous in\n{}      esac\n", values);
    cases += "      ;;\n";
  });
  return fmt::format(R"(# Completion of graphdrl for bash, made by `graphdrl completion bash`.
_graphdrl() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command= words= options= values= i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$command ${{COMP_WORDS[i]}}" in
{}    esac
  done
  case $command in
{}  esac
  COMPREPLY=()
  if [[ $values && $values != files ]]; then
    COMPREPLY=($(compgen -W "$values" -- "$current"))
  elif [[ ! $values && $current == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
  elif [[ ! $values && $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  else
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}}
complete -F _graphdrl graphdrl
)",
                     known, cases);
}

std::string zsh_completion(const CommandEntry& program) {
  std::string text = "#compdef graphdrl\n# Completion of graphdrl for zsh, made by `graphdrl completion zsh`.\n";
  for_each_command(program, [&](const CommandEntry& entry) {
    text += fmt::format("\n{}() {{\n  local line state\n  _arguments -C", zsh_function(entry.name));
    for (const OptionEntry& option : entry.options) {
      if (option.is_positional()) continue;
      for (const std::string& name : option.names) {
        const std::string what =
            option.choices.empty() ? "_files" : fmt::format("({})", fmt::join(option.choices, " "));
        const std::string value = option.is_flag() ? "" : fmt::format(":{}:{}", zsh_text(option.value), what);
        text += fmt::format(" \\\n    {}", shell_quoted(fmt::format("{}{}[{}]{}", option.repeatable ? "*" : "", name,
                                                                    zsh_text(option.help), value)));
      }
    }
    if (entry.commands.empty()) {
      text += " \\\n    '*:file:_files'\n}\n";
      return;
    }
    text +=
        " \\\n    '1:command:->command' '*::argument:->argument'\n  case $state in\n    command)\n      local -a "
        "commands=(";
    for (const CommandEntry& command : entry.commands) {
      text += fmt::format("\n        {}",
                          shell_quoted(fmt::format("{}:{}", last_word(command.name), zsh_text(command.help))));
    }
    text += "\n      )\n      _describe command commands\n      ;;\n    argument)\n      case $line[1] in\n";
    for (const CommandEntry& command : entry.commands) {
      text += fmt::format("        {}) {} ;;\n", last_word(command.name), zsh_function(command.name));
    }
    text += "      esac\n      ;;\n  esac\n}\n";
  });
  return text + "\n_graphdrl \"$@\"\n";
}

std::string fish_completion(const CommandEntry& program) {
  std::string text = "# Completion of graphdrl for fish, made by `graphdrl completion fish`.\n";
  for_each_command(program, [&](const CommandEntry& entry) {
    // A command such as `maps info` is known by both words.
    std::string seen;
    for (std::size_t begin = 0; begin < entry.name.size();) {
      const std::size_t end = std::min(entry.name.find(' ', begin), entry.name.size());
      seen += fmt::format("{}__fish_seen_subcommand_from {}", seen.empty() ? "" : "; and ",
                          entry.name.substr(begin, end - begin));
      begin = end + 1;
    }
    const std::string words = fmt::format("{}", fmt::join(words_of(entry), " "));
    const std::string unseen = entry.name.empty()
                                   ? std::string("__fish_use_subcommand")
                                   : fmt::format("{}; and not __fish_seen_subcommand_from {}", seen, words);
    for (const CommandEntry& command : entry.commands) {
      text += fmt::format("complete -c graphdrl -f -n {} -a {} -d {}\n", shell_quoted(unseen), last_word(command.name),
                          shell_quoted(command.help));
    }
    for (const OptionEntry& option : entry.options) {
      if (option.is_positional()) continue;
      const std::string when = entry.name.empty() ? "" : " -n " + shell_quoted(seen);
      text += fmt::format("complete -c graphdrl{}", when);
      for (const std::string& name : option.names) {
        text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2)) : fmt::format(" -s {}", name.substr(1));
      }
      if (!option.choices.empty())
        text += fmt::format(" -x -a {}", shell_quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      if (option.choices.empty() && !option.is_flag()) text += " -r";
      text += fmt::format(" -d {}\n", shell_quoted(option.help));
    }
  });
  return text;
}

}  // namespace graphdrl
