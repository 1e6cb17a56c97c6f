#include "apps/mounting_file.h"

#include <fmt/format.h>

#include "apps/result_file.h"
#include "settings/document.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

constexpr const char* kName = "mounting.toml";

std::string LinesOf(const AlignedAxis& aligned) {
  return fmt::format("at = {}\ntop_tilt_urad = {:.4g}\nside_tilt_urad = {:.4g}\n",
                     settings::Quoted(aligned.at), aligned.top_tilt / settings::kMicroradian,
                     aligned.side_tilt / settings::kMicroradian);
}

}  // namespace

std::optional<MountingFile> ReadMounting(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / kName)) return {};
  const auto document = settings::Document::Read(folder / kName);
  const settings::Table root = document.Root();
  MountingFile mounting{root.Text("id"), {}};
  const settings::Table axes = root.Child("aligned");
  for (const char axis : {'X', 'Y', 'Z'}) {
    const std::string name(1, axis);
    if (!axes.Has(name)) continue;
    const settings::Table table = axes.Child(name);
    mounting.aligned[axis] = {table.Text("at"), table.Quantity("top_tilt_urad"),
                              table.Quantity("side_tilt_urad")};
    table.RefuseUnknown();
  }
  axes.RefuseUnknown();
  root.RefuseUnknown();
  return mounting;
}

void WriteMounting(const MountingFile& mounting, const std::filesystem::path& folder) {
  std::string text = fmt::format(
      "# The set-up of head and target, by `abbe align`: sweeps into this folder state it.\n"
      "id = {}\n",
      settings::Quoted(mounting.id));
  for (const auto& [axis, aligned] : mounting.aligned) {
    text += fmt::format("[aligned.{:c}]\n{}", axis, LinesOf(aligned));
  }
  WriteText(text, folder / kName);
}

std::string AlignedText(const MountingFile& mounting, char axis) {
  const auto aligned = mounting.aligned.find(axis);
  return aligned == mounting.aligned.end() ? "" : "[mounting.aligned]\n" + LinesOf(aligned->second);
}

}  // namespace abbe::apps
