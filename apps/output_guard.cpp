#include "apps/output_guard.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "failure/failure.h"
#include "recording/whole_file.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

// The options of all commands that name an output.
constexpr std::array<std::string_view, 6> kOutputs{"--out",   "--json",       "--pdf",
                                                   "--truth", "--ready-file", "to"};

bool IsOutput(const CLI::Option& option) {
  const std::string name = option.get_name();
  const auto& long_names = option.get_lnames();
  return std::any_of(kOutputs.begin(), kOutputs.end(), [&](std::string_view output) {
    if (!output.starts_with("--")) return name == output;
    return std::find(long_names.begin(), long_names.end(), output.substr(2)) != long_names.end();
  });
}

// An input that its own command may write anew.
bool MayReplace(const CLI::App& command, const CLI::Option& option) {
  return option.get_name() == "--store" ||
         (command.get_name() == "track" && option.get_name() == "map");
}

// The folder in which a file of this name, or a folder, would be made; none for a device.
fs::path FolderOf(const fs::path& output) {
  std::error_code error;
  const fs::file_status status = fs::status(output, error);
  if (fs::is_directory(status)) return output;
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  fs::path folder = fs::absolute(output, error).parent_path();
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  return fs::is_directory(folder, error) ? folder : fs::path();
}

struct Places {
  std::vector<fs::path> inputs, outputs;
  std::vector<fs::path> named;  // outputs that need not be there
};

void Gather(const CLI::App& command, Places& places) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    for (const std::string& word : option->results()) {
      std::error_code error;
      if (IsOutput(*option)) places.named.emplace_back(word);
      if (!fs::is_regular_file(word, error)) continue;
      if (MayReplace(command, *option)) continue;
      (IsOutput(*option) ? places.outputs : places.inputs).emplace_back(word);
    }
  }
  for (const CLI::App* below : command.get_subcommands({})) Gather(*below, places);
}

void AddForce(CLI::App& command, const std::shared_ptr<bool>& force) {
  const auto options = command.get_options();
  if (std::any_of(options.begin(), options.end(),
                  [](const auto* each) { return IsOutput(*each); })) {
    command.add_flag("--force", *force, "Overwrite existing files");
  }
  for (CLI::App* below : command.get_subcommands({})) AddForce(*below, force);
}

}  // namespace

void RefuseUnwritable(const fs::path& output) {
  const fs::path folder = FolderOf(output);
  if (folder.empty() || access(folder.c_str(), W_OK | X_OK) == 0) return;
  throw InputError(fmt::format("{}: cannot be created: {}; choose a folder that can be written",
                               output.string(), std::strerror(errno)));
}

void GuardOutputs(CLI::App& program) {
  const auto force = std::make_shared<bool>(false);
  AddForce(program, force);
  program.parse_complete_callback([&program, force] {
    Places places;
    Gather(program, places);
    recording::SetOverwriting({places.inputs, *force});
    for (const fs::path& output : places.outputs) recording::RefuseToOverwrite(output);
    for (const fs::path& output : places.named) RefuseUnwritable(output);
  });
}

}  // namespace abbe::apps
