// `completion`: completions for shells and manual pages, made of the program's own tables of options.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <boost/algorithm/string/split.hpp>
#include <cctype>
#include <filesystem>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

using Options = std::vector<const CLI::Option*>;

struct Command {
  std::string name;  // "maps info"; empty for the program
  std::string help;
  Options options;
  std::vector<Command> commands;
};

// train: the parser that has its options.
Command command_of(const CLI::App& app, const std::string& name, const CLI::App& train) {
  Command command{.name = name,
                  .help = app.get_description(),
                  .options = (name == "train" ? train : app).get_options(),
                  .commands = {}};
  for (const CLI::App* const sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    command.commands.push_back(command_of(*sub, name.empty() ? sub->get_name() : name + ' ' + sub->get_name(), train));
  }
  return command;
}

// The program, then every command, each before its own.
template <typename Visit>
void for_each_command(const Command& command, const Visit& visit) {
  visit(command);
  for (const Command& sub : command.commands) for_each_command(sub, visit);
}

std::string last_word(const std::string& name) {
  return name.substr(name.rfind(' ') + 1);
}

// The words that go on from it.
std::string words_of(const Command& command) {
  std::vector<std::string> words;
  for (const Command& sub : command.commands) words.push_back(last_word(sub.name));
  return fmt::format("{}", fmt::join(words, " "));
}

// "-o", "--out"; empty for an argument.
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

// What a value is called: "FILE"; empty for a flag.
std::string value_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  const std::string type = option.get_type_name();
  const std::string value = type.substr(0, type.find_first_of(":{ "));
  return !value.empty() ? value : option.nonpositional() ? "VALUE" : option.get_name();
}

// All values that are allowed, if they are few: those of "{4,8}" in its type's name.
std::vector<std::string> choices_of(const CLI::Option& option) {
  std::vector<std::string> choices;
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open);
  if (value_of(option).empty() || open == std::string::npos || close == std::string::npos) return choices;
  return boost::split(choices, type.substr(open + 1, close - open - 1), boost::is_any_of(","));
}

std::string help_of(const CLI::Option& option) {
  const std::string standard = option.get_default_str();
  return option.get_description() + (standard.empty() ? "" : fmt::format(" (default: {})", standard));
}

// For a shell, between single quotes.
std::string shell_quoted(const std::string& text) {
  return '\'' + boost::replace_all_copy(text, "'", "'\\''") + '\'';
}

std::string bash_completion(const Command& program) {
  std::string known;
  std::string cases;
  for_each_command(program, [&](const Command& command) {
    for (const Command& sub : command.commands) {
      known += fmt::format("      '{} {}') command='{}' ;;\n", command.name, last_word(sub.name), sub.name);
    }
    std::vector<std::string> all_names;
    std::string values;
    for (const CLI::Option* const option : command.options) {
      const std::vector<std::string> names = names_of(*option);
      all_names.insert(all_names.end(), names.begin(), names.end());
      if (names.empty() || value_of(*option).empty()) continue;
      const std::vector<std::string> choices = choices_of(*option);
      values += fmt::format("        {}) values={} ;;\n", fmt::join(names, "|"),
                            choices.empty() ? "files" : shell_quoted(fmt::format("{}", fmt::join(choices, " "))));
    }
    cases += fmt::format("    {})\n      words={} options={}\n", shell_quoted(command.name),
                         shell_quoted(words_of(command)), shell_quoted(fmt::format("{}", fmt::join(all_names, " "))));
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

// Escapes brackets and colons, which mean something to zsh's _arguments.
std::string zsh_text(std::string text) {
  for (const char* const special : {"\\", "[", "]", ":"})
    boost::replace_all(text, special, std::string("\\") + special);
  return text;
}

std::string zsh_function(const std::string& name) {
  return "_graphdrl" + (name.empty() ? "" : '_' + boost::replace_all_copy(name, " ", "_"));
}

std::string zsh_completion(const Command& program) {
  std::string text = "#compdef graphdrl\n# Completion of graphdrl for zsh, made by `graphdrl completion zsh`.\n";
  for_each_command(program, [&](const Command& command) {
    text += fmt::format("\n{}() {{\n  local line state\n  _arguments -C", zsh_function(command.name));
    for (const CLI::Option* const option : command.options) {
      const std::string value = zsh_text(value_of(*option));
      const std::vector<std::string> choices = choices_of(*option);
      const std::string what = choices.empty() ? "_files" : fmt::format("({})", fmt::join(choices, " "));
      for (const std::string& name : names_of(*option)) {
        const std::string spec =
            fmt::format("{}{}[{}]{}", option->get_expected_max() > 1 ? "*" : "", name, zsh_text(help_of(*option)),
                        value.empty() ? "" : fmt::format(":{}:{}", value, what));
        text += " \\\n    " + shell_quoted(spec);
      }
    }
    if (command.commands.empty()) {
      text += " \\\n    '*:file:_files'\n}\n";
      return;
    }
    std::string descriptions;
    std::string cases;
    for (const Command& sub : command.commands) {
      const std::string word = last_word(sub.name);
      descriptions += fmt::format("\n        {}", shell_quoted(word + ':' + zsh_text(sub.help)));
      cases += fmt::format("        {}) {} ;;\n", word, zsh_function(sub.name));
    }
    text += fmt::format(R"( \
    '1:command:->command' '*::argument:->argument'
  case $state in
    command)
      local -a commands=({}
      )
      _describe command commands
      ;;
    argument)
      case $line[1] in
{}      esac
      ;;
  esac
}}
)",
                        descriptions, cases);
  });
  return text + "\n_graphdrl \"$@\"\n";
}

std::string fish_completion(const Command& program) {
  std::string text = "# Completion of graphdrl for fish, made by `graphdrl completion fish`.\n";
  for_each_command(program, [&](const Command& command) {
    // A command such as `maps info` is known by both words.
    const std::string seen = "__fish_seen_subcommand_from " +
                             boost::replace_all_copy(command.name, " ", "; and __fish_seen_subcommand_from ");
    const std::string unseen = command.name.empty()
                                   ? std::string("__fish_use_subcommand")
                                   : seen + "; and not __fish_seen_subcommand_from " + words_of(command);
    for (const Command& sub : command.commands) {
      text += fmt::format("complete -c graphdrl -f -n {} -a {} -d {}\n", shell_quoted(unseen), last_word(sub.name),
                          shell_quoted(sub.help));
    }
    for (const CLI::Option* const option : command.options) {
      if (!option->nonpositional()) continue;
      text += "complete -c graphdrl" + (command.name.empty() ? "" : " -n " + shell_quoted(seen));
      for (const std::string& name : option->get_snames()) text += " -s " + name;
      for (const std::string& name : option->get_lnames()) text += " -l " + name;
      if (const auto choices = choices_of(*option); !choices.empty()) {
        text += " -x -a " + shell_quoted(fmt::format("{}", fmt::join(choices, " ")));
      } else if (!value_of(*option).empty()) {
        text += " -r";
      }
      text += fmt::format(" -d {}\n", shell_quoted(help_of(*option)));
    }
  });
  return text;
}

// "graphdrl-maps-info" of "maps info".
std::string page_name(const std::string& command) {
  return "graphdrl" + (command.empty() ? "" : '-' + boost::replace_all_copy(command, " ", "-"));
}

// Escapes text for roff: keeps hyphens, and lets no line look like a request.
std::string roff(std::string text) {
  boost::replace_all(text, "\\", "\\e");
  boost::replace_all(text, "-", "\\-");
  return text.starts_with('.') || text.starts_with('\'') ? "\\&" + text : text;
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string roff_option(const CLI::Option& option) {
  std::vector<std::string> names = names_of(option);
  for (std::string& name : names) name = "\\fB" + roff(name) + "\\fR";
  std::string head = fmt::format("{}", fmt::join(names, ", "));
  const std::string value = value_of(option);
  if (!value.empty()) head += fmt::format("{}\\fI{}\\fR", head.empty() ? "" : " ", roff(value));
  std::string help = roff(help_of(option));
  const std::vector<std::string> choices = choices_of(option);
  if (!choices.empty()) help += roff(fmt::format(" ({})", fmt::join(choices, ", ")));
  return fmt::format(".TP\n{}\n{}.\n", head, help);
}

// Of one of the program's commands, in man's macros for roff.
std::string manual_page(const Command& program, const Command& command) {
  const std::string name = page_name(command.name);
  std::string text =
      fmt::format(".TH \"{}\" 1 \"\" \"graphdrl {}\" \"User Commands\"\n", upper_case(name), GRAPHDRL_VERSION);
  text += fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(command.help));
  text += fmt::format(".SH SYNOPSIS\n.B graphdrl{}{}\n[\\fIOPTIONS\\fR]", command.name.empty() ? "" : " ",
                      roff(command.name));
  for (const CLI::Option* const option : command.options) {
    if (option->nonpositional()) continue;
    const std::string value = fmt::format("\\fI{}\\fR", roff(value_of(*option)));
    text += option->get_required() ? ' ' + value : " [" + value + ']';
  }
  text += command.commands.empty() ? "\n" : " \\fICOMMAND\\fR ...\n.SH COMMANDS\n";
  for (const Command& sub : command.commands) {
    text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}.\n", roff(page_name(sub.name)), roff(sub.help));
  }
  Options options = command.options;
  std::stable_partition(options.begin(), options.end(), [](const auto* option) { return !option->nonpositional(); });
  std::string group;
  for (const CLI::Option* const option : options) {
    const std::string heading = option->nonpositional() ? option->get_group() : "Arguments";
    if (heading != group) text += fmt::format(".SH {}\n", roff(upper_case(heading)));
    group = heading;
    text += roff_option(*option);
  }
  text +=
      ".SH EXIT STATUS\n0: done. 2: bad input, said in one line on standard error. 1: a fault of the program's. 130, "
      "143: interrupted; what was done is printed or saved.\n";
  std::vector<std::string> others;
  for_each_command(program, [&](const Command& other) {
    if (other.name != command.name) others.push_back(fmt::format("\\%\\fB{}\\fR(1)", roff(page_name(other.name))));
  });
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(others, ", "));
}

// Writes a folder such as /usr/share: completions and manual pages in their places.
void install(const Command& program, const std::filesystem::path& share) {
  const auto write = [&](const std::filesystem::path& path, const std::string& text) {
    prepare_folder((share / path).parent_path());
    write_file(share / path, text);
  };
  write("bash-completion/completions/graphdrl", bash_completion(program));
  write("zsh/vendor-completions/_graphdrl", zsh_completion(program));
  write("fish/vendor_completions.d/graphdrl.fish", fish_completion(program));
  for_each_command(program, [&](const Command& command) {
    write("man/man1/" + page_name(command.name) + ".1", manual_page(program, command));
  });
}

struct CompletionOptions {
  std::string shell;
  std::string share;
};

void complete(const Command& program, const CompletionOptions& options) {
  if (!options.share.empty()) return install(program, options.share);
  if (options.shell == "bash") return print_text(bash_completion(program));
  if (options.shell == "zsh") return print_text(zsh_completion(program));
  if (options.shell == "fish") return print_text(fish_completion(program));
  throw Error({.what = "no shell is named", .expected = "bash, zsh or fish"});
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("completion", "Print the completion of commands for a shell");
  const auto options = std::make_shared<CompletionOptions>();
  CLI::Option* const shell = command.add_option("shell", options->shell, "The shell")
                                 ->check(CLI::IsMember({"bash", "zsh", "fish"}))
                                 ->type_name("SHELL");
  add_text_option(command, "--install", options->share, "FOLDER",
                  "Write all completions and manual pages below this folder instead, as below /usr/share")
      ->excludes(shell);
  command.callback([options, &app] {
    visit_train_options([&](const CLI::App& train) { complete(command_of(app, "", train), *options); });
  });
}

}  // namespace graphdrl
