#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "graphdrl/cli/command_table.h"

namespace graphdrl {
namespace {

// Escapes text for roff: keeps hyphens, and lets no line look like a request.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string roff_option(const OptionEntry& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back("\\fB" + roff(name) + "\\fR");
  std::string head = fmt::format("{}", fmt::join(names, ", "));
  if (!option.is_flag()) head += fmt::format("{}\\fI{}\\fR", head.empty() ? "" : " ", roff(option.value));
  std::string help = roff(option.help);
  if (!option.choices.empty()) help += roff(fmt::format(" ({})", fmt::join(option.choices, ", ")));
  return fmt::format(".TP\n{}\n{}.\n", head, help);
}

}  // namespace

std::string page_name(const std::string& command) {
  std::string name = "graphdrl";
  if (!command.empty()) name += "-" + command;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string manual_page(const CommandEntry& program, const CommandEntry& entry) {
  std::string text = fmt::format(".TH \"{}\" 1 \"\" \"graphdrl {}\" \"User Commands\"\n",
                                 upper_case(page_name(entry.name)), GRAPHDRL_VERSION);
  text += fmt::format(".SH NAME\n{} \\- {}\n", roff(page_name(entry.name)), roff(entry.help));
  text +=
      fmt::format(".SH SYNOPSIS\n.B graphdrl{}\n[\\fIOPTIONS\\fR]", entry.name.empty() ? "" : " " + roff(entry.name));
  for (const OptionEntry& option : entry.options) {
    if (!option.is_positional()) continue;
    text += option.required ? fmt::format(" \\fI{}\\fR", roff(option.value))
                            : fmt::format(" [\\fI{}\\fR]", roff(option.value));
  }
  text += entry.commands.empty() ? "\n" : " \\fICOMMAND\\fR ...\n";
  if (!entry.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const CommandEntry& command : entry.commands) {
      text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}.\n", roff(page_name(command.name)), roff(command.help));
    }
  }
  std::string group;
  for (const bool positional : {true, false}) {
    for (const OptionEntry& option : entry.options) {
      if (option.is_positional() != positional) continue;
      const std::string heading = positional ? "Arguments" : option.group;
      if (heading != group) text += fmt::format(".SH {}\n", roff(upper_case(heading)));
      group = heading;
      text += roff_option(option);
    }
  }
  text +=
      ".SH EXIT STATUS\n0: done. 2: bad input, said in one line on standard error. 1: a fault of the program's. 130, "
      "143: interrupted; what was done is printed or saved.\n";
  std::vector<std::string> others;
  for_each_command(program, [&](const CommandEntry& other) {
    if (other.name != entry.name) others.push_back(fmt::format("\\%\\fB{}\\fR(1)", roff(page_name(other.name))));
  });
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(others, ", "));
}

}  // namespace graphdrl
