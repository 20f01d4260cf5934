#include <filesystem>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/command_table.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

// Writes a folder such as /usr/share: completions and manual pages in their places.
void install(const CommandEntry& program, const std::filesystem::path& share) {
  const auto write = [&](const std::filesystem::path& path, const std::string& text) {
    prepare_folder((share / path).parent_path());
    write_file(share / path, text);
  };
  write("bash-completion/completions/graphdrl", bash_completion(program));
  write("zsh/vendor-completions/_graphdrl", zsh_completion(program));
  write("fish/vendor_completions.d/graphdrl.fish", fish_completion(program));
  for_each_command(program, [&](const CommandEntry& entry) {
    write(std::filesystem::path("man") / "man1" / (page_name(entry.name) + ".1"), manual_page(program, entry));
  });
}

}  // namespace

void add_completion_command(CLI::App& app) {
  struct CompletionOptions {
    std::string shell;
    std::string share;
  };
  CLI::App* const command = app.add_subcommand("completion", "Print the completion of commands for a shell");
  const auto options = std::make_shared<CompletionOptions>();
  CLI::Option* const shell = command->add_option("shell", options->shell, "The shell")
                                 ->check(CLI::IsMember({"bash", "zsh", "fish"}))
                                 ->type_name("SHELL");
  command
      ->add_option("--install", options->share,
                   "Write all completions and manual pages below this folder instead, as below /usr/share")
      ->check(not_empty())
      ->type_name("FOLDER")
      ->excludes(shell);
  command->callback([options, &app] {
    const CommandEntry program = command_table(app);
    if (!options->share.empty()) return install(program, options->share);
    if (options->shell == "bash") return print_text(bash_completion(program));
    if (options->shell == "zsh") return print_text(zsh_completion(program));
    if (options->shell == "fish") return print_text(fish_completion(program));
    throw Error({.what = "no shell is named", .expected = "bash, zsh or fish"});
  });
}

}  // namespace graphdrl
