// abbe convert: a recording from one form of file to another, and files of others into recordings.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/commands.h"
#include "recording/import.h"
#include "recording/recording_file.h"

namespace abbe::apps {
namespace {

struct ConvertOptions {
  std::filesystem::path from;
  std::filesystem::path to;
  recording::ImportOptions import;
  bool quiet = false;
};

int Convert(const ConvertOptions& options) {
  if (std::filesystem::exists(options.to)) {
    throw InputError(
        fmt::format("{}: exists already, and nothing recorded is overwritten; choose another name",
                    options.to.string()));
  }
  const auto imported = recording::Import(options.from, options.import);
  const recording::Recording recording = imported ? *imported : recording::Read(options.from);
  recording::Write(recording, options.to);
  for (const std::string& warning : recording.warnings) fmt::print(stderr, "abbe: {}\n", warning);
  if (!options.quiet) {
    fmt::print("{}: {}, {} rows, {} columns\n", options.to.string(), recording.Kind(),
               recording.rows(), recording.columns.size());
  }
  return kDone;
}

}  // namespace

void AddConvert(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert", "A recording from CSV to HDF5 or back, or from a table of another program");
  command->add_option("from", options->from, "A recording (.csv, .h5, .hdf5) or a table (.dat)")
      ->required();
  command->add_option("to", options->to, "The new recording (.csv, .h5, .hdf5)")->required();
  command->add_option("--axis", options->import.axis, "The axis of a table that does not say (X)")
      ->check(CLI::IsMember({"X", "Y", "Z"}));
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer("Example: abbe convert sweep_X.csv sweep_X.h5");
  command->callback([options, &exit_code] { exit_code = Convert(*options); });
}

}  // namespace abbe::apps
