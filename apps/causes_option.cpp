#include "apps/causes_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/instruments.h"
#include "settings/unit.h"
#include "simulation/kinds.h"
#include "simulation/path_displacement.h"

namespace abbe::apps {

using simulation::Change;
using simulation::CorrectedBy;
using simulation::ModelledCause;

namespace {

using settings::kMicro;

void Join(const Change& change, Change& all) {
  all.squares += change.squares;
  all.count += change.count;
  all.largest = std::max(all.largest, change.largest);
}

std::vector<std::string> NamesOf(const std::vector<ModelledCause>& causes) {
  std::vector<std::string> names;
  names.reserve(causes.size());
  for (const ModelledCause& cause : causes) names.push_back(cause.Name());
  return names;
}

std::string ChangeText(const char* what, const Change& change, const char* unit) {
  if (change.largest == 0.0) return "";
  return fmt::format("; {} by {:.3g} {} rms, {:.3g} {} at most", what, change.rms() / kMicro, unit,
                     change.largest / kMicro, unit);
}

nlohmann::ordered_json ChangeJson(const Change& change) {
  return {{"rms", change.rms() / kMicro}, {"largest", change.largest / kMicro}};
}

// Whether recordings can be corrected for the cause: parameters of the head cannot be removed from
// gaps, and those of the machine stay in its map.
bool Takes(const ModelledCause& cause) {
  return cause.cause->columns || cause.object.kind() == simulation::Object::Kind::kPivot ||
         cause.object.kind() == simulation::Object::Kind::kLink;
}

}  // namespace

CLI::Option* AddCausesOption(CLI::App& command, std::filesystem::path& path) {
  return command.add_option("--causes", path,
                            "Extended model (abbe diagnose -o): the recordings are corrected "
                            "for its causes first");
}

CauseCorrection::CauseCorrection(const std::filesystem::path& path, const MachineFile& file,
                                 const Corrections& taken)
    : instruments_(InstrumentsOf(file)) {
  if (path.empty()) return;
  name_ = path.filename().string();
  simulation::ExtendedModel model = simulation::ReadExtendedModel(
      path, {file.sweep_setup.machine.name, true,
             file.linkage ? file.linkage->chain.joints() : Eigen::Index{0}});
  origin_ = model.origin;
  for (ModelledCause& cause : model.causes) {
    const CorrectedBy seat = cause.cause->CorrectedAt(cause.object);
    const bool wanted = std::find(taken.begin(), taken.end(), seat) != taken.end();
    (wanted && Takes(cause) ? taken_ : left_).push_back(std::move(cause));
  }
}

recording::Recording CauseCorrection::Take(recording::Recording recording) {
  if (taken_.empty()) return recording;
  simulation::Correction corrected = simulation::Correct(recording, taken_, origin_, instruments_);
  Join(corrected.changes.positions, changes_.positions);
  Join(corrected.changes.gaps, changes_.gaps);
  Join(corrected.changes.angles, changes_.angles);
  return std::move(corrected.recording);
}

std::string CauseCorrection::Line() const {
  if (!Active()) return "";
  const auto list = [](const std::vector<ModelledCause>& causes) {
    return causes.empty() ? std::string("none")
                          : fmt::format("{}", fmt::join(NamesOf(causes), ", "));
  };
  std::string line = fmt::format("causes of {} taken out: {}", name_, list(taken_));
  line += ChangeText("positions", changes_.positions, "um");
  line += ChangeText("gaps", changes_.gaps, "um");
  line += ChangeText("angles", changes_.angles, "urad");
  if (!left_.empty()) line += fmt::format("; left in: {}", list(left_));
  return line;
}

PathCauses::PathCauses(const std::filesystem::path& path, const std::string& machine,
                       double feed_mm_min)
    : feed_(feed_mm_min * settings::UnitOf("_mm_min").si) {
  constexpr Eigen::Index kAnyLinkage = 9;  // pivots: a map has no linkage
  if (path.empty()) return;
  name_ = path.filename().string();
  for (auto& cause : simulation::ReadExtendedModel(path, {machine, true, kAnyLinkage}).causes) {
    if (cause.cause->CorrectedAt(cause.object) != CorrectedBy::kMotion) continue;
    (simulation::ActsOnPath(cause) ? causes_ : left_).push_back(std::move(cause));
  }
}

Eigen::Matrix3Xd PathCauses::Beside(const Eigen::Matrix3Xd& path) const {
  return simulation::PathDisplacement(path, feed_, causes_);
}

std::vector<std::string> PathCauses::Names() const { return NamesOf(causes_); }

std::string PathCauses::Line() const {
  std::string line =
      fmt::format("in addition to the map, from {}: {}", name_,
                  causes_.empty() ? "nothing" : fmt::format("{}", fmt::join(Names(), ", ")));
  if (!left_.empty()) {
    line += fmt::format("; left out, because a path has no time and no temperature: {}",
                        fmt::join(NamesOf(left_), ", "));
  }
  return line;
}

void AddPathCauses(CLI::App& command, std::filesystem::path& path, double& feed_mm_min) {
  command.add_option("--causes", path,
                     "Extended model (abbe diagnose -o): errors of the machine that its map lacks");
  command
      .add_option("--feed-mm-min", feed_mm_min,
                  "With --causes: the feed, for lag (0: at standstill at each point)")
      ->check(CLI::NonNegativeNumber);
}

nlohmann::ordered_json CauseCorrection::Data() const {
  return {{"file", name_},
          {"taken_out", NamesOf(taken_)},
          {"left_in", NamesOf(left_)},
          {"positions_um", ChangeJson(changes_.positions)},
          {"gaps_um", ChangeJson(changes_.gaps)},
          {"angles_urad", ChangeJson(changes_.angles)}};
}

}  // namespace abbe::apps
