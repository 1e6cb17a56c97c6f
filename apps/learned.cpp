// abbe learned: learned terms of extended models, by name, and what makes such things.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "learned/words.h"

namespace abbe::apps {

void AddLearnedCommand(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "learned", "What makes learned terms on machines: suggestions, as a Markdown table");
  command->footer("Example: abbe learned > makers.md");
  command->callback([&exit_code] {
    fmt::print("{}", learned::MakersTable());
    exit_code = kDone;
  });
}

}  // namespace abbe::apps
