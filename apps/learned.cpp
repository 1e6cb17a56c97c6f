// abbe learned: what makes learned terms on machines; a name for one.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/result_file.h"
#include "failure/failure.h"
#include "learned/carried.h"
#include "learned/words.h"
#include "recording/whole_file.h"

namespace abbe::apps {
namespace {

struct NameArguments {
  std::filesystem::path file;
  std::string term;
  learned::Naming naming;
};

int Name(const NameArguments& arguments) {
  std::ifstream file(arguments.file);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    throw InputError(
        fmt::format("{}: cannot be read; give an extended model", arguments.file.string()));
  }
  const std::string named =
      learned::WithName(text.str(), arguments.file.string(), arguments.term, arguments.naming);
  // To change this file is what was asked for.
  recording::SetOverwriting({});
  WriteText(named, arguments.file);
  fmt::print("{}: {} is now \"{}\"\n", arguments.file.string(), arguments.term,
             arguments.naming.name);
  return kDone;
}

}  // namespace

void AddLearnedCommand(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "learned", "What makes learned terms on machines: suggestions, as a Markdown table");
  command->footer("Example: abbe learned > makers.md");
  command->callback([command, &exit_code] {
    if (!command->get_subcommands().empty()) return;
    fmt::print("{}", learned::MakersTable());
    exit_code = kDone;
  });
  auto arguments = std::make_shared<NameArguments>();
  CLI::App* name =
      command->add_subcommand("name", "Gives a learned term a name, by which all output knows it");
  name->add_option("file", arguments->file, "Extended model (TOML) with the term")->required();
  name->add_option("term", arguments->term, "Its number in the file, its expression or its name")
      ->required();
  name->add_option("--name", arguments->naming.name, "Short, as those of causes: cover-drag")
      ->required();
  name->add_option("--words", arguments->naming.words, "What it is, in a sentence");
  name->footer(
      "Example: abbe learned name mill.causes.toml 1 --name cover-drag --words \"the way cover "
      "drags\"");
  name->callback([arguments, &exit_code] { exit_code = Name(*arguments); });
}

}  // namespace abbe::apps
