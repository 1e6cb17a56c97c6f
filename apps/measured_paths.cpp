#include "apps/measured_paths.h"

#include <fmt/format.h>

#include <utility>

#include "apps/linkage_reader.h"
#include "apps/machine_recording.h"
#include "apps/protocol.h"
#include "recording/made_on.h"
#include "recording/started.h"

namespace abbe::apps {
namespace {

using recording::Recording;

// With a reference only, the machine file needs no linkage.
struct Machine {
  explicit Machine(const PathSources& sources) : calibration(sources.calibration) {
    if (!sources.machine.empty()) {
      file = ReadMachineFile(sources.machine);
      causes.emplace(sources.causes, *file, kForMeasuring);
    } else if (!sources.causes.path.empty()) {
      throw InputError("--causes needs the machine file; add --machine FILE");
    }
  }

  LinkageReader& Reader(const Recording& recording) { return Reader(recording, reader); }

  // From a path to the one without the causes that are not certain.
  Eigen::Matrix3Xd DoubtfulChange(const Recording& recording, const paths::MeasuredPath& path) {
    return Reader(recording, reader_of_certain).Path(causes->TakeCertain(recording)).measured -
           path.measured;
  }

  bool WidensU95() const { return causes && causes->WidensU95(); }

  LinkageReader& Reader(const Recording& recording, std::optional<LinkageReader>& which) const {
    if (!file) {
      throw InputError(fmt::format(
          "{}: a recording of the linkage is evaluated with its machine file; add --machine FILE",
          recording.name));
    }
    if (!which) which.emplace(*file, calibration);
    return *which;
  }

  std::filesystem::path calibration;
  std::optional<MachineFile> file;
  std::optional<CauseCorrection> causes;
  std::optional<LinkageReader> reader, reader_of_certain;
  std::vector<Eigen::Matrix3Xd> changes;  // of each path of the linkage
};

void Add(const Recording& read, Machine& machine, MeasuredPaths& paths) {
  const Recording recording = machine.causes ? machine.causes->Take(read) : read;
  const bool angles = recording.Find("pivot_1_rad").has_value();
  const bool reference = paths::HasReference(recording);
  const bool radius = paths::HasRadius(recording);
  if (!angles && !reference && !radius) {
    throw InputError(
        fmt::format("{}: has neither encoder angles (pivot_1_rad ...) nor reference positions "
                    "(ref_x_mm ...) nor radii (ref_radius_mm): no path to evaluate",
                    recording.name));
  }
  if (machine.file)
    recording::RefuseOtherMachine(recording, machine.file->sweep_setup.machine.name);
  if (angles) {
    paths.linkage.push_back(machine.Reader(recording).Path(recording));
    if (machine.WidensU95()) {
      machine.changes.push_back(machine.DoubtfulChange(read, paths.linkage.back()));
    }
  }
  if (reference) paths.reference.push_back(paths::ReferencePath(recording));
  if (radius) paths.reference.push_back(paths::BallbarPath(recording));
  for (const auto& [key, text] :
       {std::pair{"machine", recording.HeaderText("machine").value_or("")},
        std::pair{"started", recording::StartedText(recording)}}) {
    if (!text.empty() && !paths.head.contains(key)) paths.head[key] = text;
  }
  AddProtocol(recording, paths.head);
}

}  // namespace

void AddPathSources(CLI::App& command, PathSources& sources) {
  command
      .add_option("recordings", sources.recordings,
                  "Recordings of kind linkage, reference or ballbar, any number")
      ->required();
  command.add_option("--machine", sources.machine, "Machine file; the linkage needs it");
  command.add_option("--calibration", sources.calibration,
                     "Calibration file of abbe calibrate (default: nominal parameters)");
  AddCausesOption(command, sources.causes);
}

std::vector<paths::MeasuredPath> MeasuredPaths::All() const {
  std::vector<paths::MeasuredPath> all = linkage;
  all.insert(all.end(), reference.begin(), reference.end());
  return all;
}

std::vector<paths::MeasuredPath> MeasuredPaths::WithError(std::size_t error) const {
  std::vector<paths::MeasuredPath> all = All();
  for (std::size_t i = 0; i < linkage.size(); ++i) all[i].measured += errors[error][i];
  return all;
}

MeasuredPaths ReadMeasuredPaths(const PathSources& sources) {
  Machine machine(sources);
  MeasuredPaths paths;
  for (const std::filesystem::path& file : sources.recordings) {
    Add(ReadWithWarnings(file), machine, paths);
  }
  if (machine.file) {
    paths.machine = machine.file->sweep_setup.machine;
    paths.head["machine"] = paths.machine->name;
    paths.head["chain"] = paths.machine->chain.Text();
    if (machine.causes->Active()) paths.head["causes_taken_out"] = machine.causes->Data();
  }
  if (machine.reader) {
    paths.errors = machine.reader->IndependentErrors();
    if (machine.WidensU95()) {
      paths.errors.push_back(machine.changes);
      paths.unexplained = machine.causes->unexplained();
    }
    paths.head["linkage"] = machine.reader->Data();
    paths.notes = machine.reader->Notes();
    if (machine.causes->Active()) paths.notes.push_back(machine.causes->Line());
  } else if (!sources.calibration.empty()) {
    throw InputError(fmt::format(
        "--calibration {}: none of the recordings is of the linkage; leave the option out",
        sources.calibration.string()));
  }
  return paths;
}

nlohmann::ordered_json ResultHead(const std::string& command, const MeasuredPaths& paths) {
  nlohmann::ordered_json head{{"abbe", ABBE_VERSION}, {"command", command}};
  head.update(paths.head);
  return head;
}

}  // namespace abbe::apps
