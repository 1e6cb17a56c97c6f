#include "apps/measured_paths.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "apps/machine_file.h"
#include "machine/machine.h"
#include "recording/recording_file.h"
#include "relm/tip_path.h"

namespace abbe::apps {
namespace {

using recording::Recording;

// Turns encoder angles into ball positions with what the machine file says of the linkage.
class LinkageReader {
 public:
  explicit LinkageReader(const PathSources& sources)
      : file_(ReadMachineFile(sources.machine)),
        machine_(machine::ReadMachine(file_.document.Root())) {
    if (!file_.linkage) {
      throw InputError(fmt::format(
          "{}: has no table [linkage]; add one with the form and the lengths of the linkage",
          sources.machine.string()));
    }
    model_ = relm::MakeLinkageModel(*file_.linkage, relm::ErrorModel::kComplete);
  }

  const machine::Machine& machine() const { return machine_; }

  relm::MeasuredPath Path(const Recording& recording) const {
    const relm::TipPath tips =
        relm::EvaluateTipPath(recording, *file_.linkage, *model_, model_->Values());
    return relm::LinkagePath(recording, machine_.chain, tips.rows,
                             relm::InFrame(file_.linkage->X_MB, tips.tips));
  }

 private:
  MachineFile file_;
  machine::Machine machine_;
  std::optional<relm::LinkageModel> model_;
};

Recording ReadWithWarnings(const std::filesystem::path& path) {
  Recording recording = recording::Read(path);
  for (const std::string& warning : recording.warnings) {
    fmt::print(stderr, "abbe: {}: {}\n", path.string(), warning);
  }
  return recording;
}

void RefuseOtherMachine(const Recording& recording, const std::string& machine) {
  const auto named = recording.HeaderText("machine");
  if (!named || named == machine) return;
  throw InputError(fmt::format(
      "{}: was recorded on machine \"{}\", the machine file describes \"{}\"; give the file of the "
      "machine that was measured",
      recording.name, *named, machine));
}

}  // namespace

void AddPathSources(CLI::App& command, PathSources& sources) {
  command
      .add_option("recordings", sources.recordings,
                  "Recordings of kind linkage or reference, any number")
      ->required();
  command.add_option("--machine", sources.machine, "Machine file; the linkage needs it");
}

std::vector<relm::MeasuredPath> MeasuredPaths::All() const {
  std::vector<relm::MeasuredPath> all = linkage;
  all.insert(all.end(), reference.begin(), reference.end());
  return all;
}

MeasuredPaths ReadMeasuredPaths(const PathSources& sources) {
  std::optional<LinkageReader> reader;
  if (!sources.machine.empty()) reader.emplace(sources);
  MeasuredPaths paths;
  for (const std::filesystem::path& file : sources.recordings) {
    const Recording recording = ReadWithWarnings(file);
    const bool angles = recording.Find("pivot_1_rad").has_value();
    const bool reference = relm::HasReference(recording);
    if (!angles && !reference) {
      throw InputError(
          fmt::format("{}: has neither encoder angles (pivot_1_rad ...) nor reference positions "
                      "(ref_x_mm ...): no path to evaluate",
                      recording.name));
    }
    if (angles && !reader) {
      throw InputError(fmt::format(
          "{}: a recording of the linkage is evaluated with its machine file; add --machine FILE",
          recording.name));
    }
    if (reader) RefuseOtherMachine(recording, reader->machine().name);
    if (angles) paths.linkage.push_back(reader->Path(recording));
    if (reference) paths.reference.push_back(relm::ReferencePath(recording));
    if (paths.started.empty()) paths.started = recording.HeaderText("started").value_or("");
    if (!reader && paths.machine.empty()) {
      paths.machine = recording.HeaderText("machine").value_or("");
    }
  }
  if (reader) {
    paths.machine = reader->machine().name;
    paths.chain = reader->machine().chain.Text();
  }
  if (!paths.linkage.empty()) {
    paths.notes.push_back(
        "the linkage is evaluated with its nominal parameters: positions are off by its tolerances "
        "until it is calibrated");
  }
  return paths;
}

nlohmann::ordered_json ResultHead(const std::string& command, const MeasuredPaths& paths) {
  nlohmann::ordered_json head{{"abbe", ABBE_VERSION}, {"command", command}};
  if (!paths.machine.empty()) head["machine"] = paths.machine;
  if (!paths.chain.empty()) head["chain"] = paths.chain;
  if (!paths.started.empty()) head["started"] = paths.started;
  return head;
}

}  // namespace abbe::apps
