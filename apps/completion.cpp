// `abbe completion` and `abbe man`: what shells and man(1) want to know, from the definitions of
// the commands.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/command_tree.h"
#include "apps/commands.h"
#include "apps/result_file.h"

namespace abbe::apps {
namespace {

int WriteManPages(const CommandNode& command, const std::filesystem::path& folder) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  WriteText(ManPage(command), folder / (name + ".1"));
  int pages = 1;
  for (const CommandNode& below : command.below) pages += WriteManPages(below, folder);
  return pages;
}

}  // namespace

void AddCompletion(CLI::App& program, int& exit_code) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "completion", "Prints the completion of commands for bash, zsh or fish");
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer("Example: abbe completion bash > abbe.bash");
  command->callback([shell, &program, &exit_code] {
    fmt::print("{}", CompletionFor(TreeOf(program), *shell));
    exit_code = kDone;
  });
}

void AddMan(CLI::App& program, int& exit_code) {
  auto folder = std::make_shared<std::filesystem::path>("man");
  CLI::App* command =
      program.add_subcommand("man", "Writes the manual pages of all commands into a folder");
  command->add_option("--out", *folder, "The folder (man)");
  command->footer("Example: abbe man --out man1");
  command->callback([folder, &program, &exit_code] {
    std::filesystem::create_directories(*folder);
    fmt::print("{}: {} pages; man -l {}/abbe.1 shows one\n", folder->string(),
               WriteManPages(TreeOf(program), *folder), folder->string());
    exit_code = kDone;
  });
}

}  // namespace abbe::apps
