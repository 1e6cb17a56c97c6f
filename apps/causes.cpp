// abbe causes: what abbe diagnose looks for.
#include <fmt/format.h>

#include "apps/command.h"
#include "apps/commands.h"
#include "simulation/causes/causes_table.h"

namespace abbe::apps {

void AddCauses(CLI::App& program, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("causes", "The causes that diagnose looks for, as a Markdown table");
  command->footer("Example: abbe causes > causes.md");
  command->callback([&exit_code] {
    fmt::print("{}", simulation::CausesTable());
    exit_code = kDone;
  });
}

}  // namespace abbe::apps
