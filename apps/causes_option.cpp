#include "apps/causes_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "apps/instruments.h"
#include "settings/unit.h"
#include "simulation/doubt.h"
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
// gaps, those of the machine stay in its map, and of a random field the size alone is known.
bool Takes(const ModelledCause& cause) {
  return (cause.cause->columns && !cause.cause->IsRandomField()) ||
         cause.object.kind() == simulation::Object::Kind::kPivot ||
         cause.object.kind() == simulation::Object::Kind::kLink;
}

simulation::ExtendedModel ReadModel(const CausesOption& option,
                                    const simulation::CauseObjects& objects) {
  auto model = simulation::ReadExtendedModel(option.path, objects);
  simulation::RefuseUnexplained(model, option.path, option.although_unexplained);
  if (model.verdict.empty()) {
    fmt::print(stderr,
               "abbe: {}: states no verdict of a diagnosis; its causes are taken as certain\n",
               option.path.string());
  }
  return model;
}

// What is doubtful of those causes that are applied, and what is unexplained beside them.
std::string DoubtsOf(const simulation::ExtendedModel& model,
                     const std::vector<ModelledCause>& applied) {
  std::string text = simulation::DoubtText(model, applied);
  if (const double left = simulation::UnexplainedInSpace(model); left > 0.0) {
    text +=
        fmt::format("{}unexplained: {}; together {:.3g} um rms in space", text.empty() ? "" : "; ",
                    simulation::UnexplainedText(model), left / kMicro);
  }
  return text;
}

void AddAlthough(CLI::App& command, CausesOption& option, CLI::Option* causes) {
  command
      .add_flag("--although-unexplained", option.although_unexplained,
                "With --causes: apply causes beside which the diagnosis left something "
                "unexplained, and widen U95 by both")
      ->needs(causes);
}

}  // namespace

void AddCausesOption(CLI::App& command, CausesOption& option) {
  AddAlthough(command, option,
              command.add_option("--causes", option.path,
                                 "Extended model (abbe diagnose -o): the recordings are corrected "
                                 "for its causes first"));
}

CauseCorrection::CauseCorrection(const CausesOption& option, const MachineFile& file,
                                 const Corrections& taken)
    : CauseCorrection(option, InstrumentsOf(file), taken) {}

CauseCorrection::CauseCorrection(const CausesOption& option, simulation::Instruments instruments,
                                 const Corrections& taken)
    : instruments_(std::move(instruments)) {
  if (option.path.empty()) return;
  name_ = option.path.filename().string();
  const simulation::ExtendedModel model = ReadModel(
      option, {instruments_.machine.name, true,
               instruments_.linkage ? instruments_.linkage->chain.joints() : Eigen::Index{0}});
  origin_ = model.origin;
  verdict_ = model.verdict;
  unexplained_ = simulation::UnexplainedInSpace(model);
  for (const ModelledCause& cause : model.causes) {
    const CorrectedBy seat = cause.cause->CorrectedAt(cause.object);
    const bool wanted = std::find(taken.begin(), taken.end(), seat) != taken.end();
    (wanted && Takes(cause) ? taken_ : left_).push_back(cause);
    if (wanted && Takes(cause) && simulation::IsCertain(model, cause)) certain_.push_back(cause);
  }
  doubts_ = DoubtsOf(model, taken_);
}

recording::Recording CauseCorrection::TakeCertain(const recording::Recording& recording) const {
  return simulation::Correct(recording, certain_, origin_, instruments_).recording;
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
  if (!doubts_.empty()) line += fmt::format("; {}; U95 is widened by that", doubts_);
  return line;
}

PathCauses::PathCauses(const CausesOption& option, const std::string& machine, double feed_mm_min)
    : feed_(feed_mm_min * settings::UnitOf("_mm_min").si) {
  constexpr Eigen::Index kAnyLinkage = 9;  // pivots: a map has no linkage
  if (option.path.empty()) return;
  name_ = option.path.filename().string();
  const simulation::ExtendedModel model = ReadModel(option, {machine, true, kAnyLinkage});
  for (const ModelledCause& cause : model.causes) {
    if (cause.cause->CorrectedAt(cause.object) != CorrectedBy::kMotion) continue;
    (simulation::ActsOnPath(cause) ? causes_ : left_).push_back(cause);
  }
  doubts_ = DoubtsOf(model, causes_);
}

Eigen::Matrix3Xd PathCauses::Beside(const Eigen::Matrix3Xd& path) const {
  return simulation::PathDisplacement(path, feed_, causes_);
}

std::string PathCauses::Line() const {
  std::string line = fmt::format(
      "in addition to the map, from {}: {}", name_,
      causes_.empty() ? "nothing" : fmt::format("{}", fmt::join(NamesOf(causes_), ", ")));
  const auto add_left = [&](bool by_path, const char* why) {
    std::vector<ModelledCause> left;
    std::ranges::copy_if(left_, std::back_inserter(left), [&](const ModelledCause& cause) {
      return (cause.cause->follows == simulation::Follows::kPath) == by_path;
    });
    if (left.empty()) return;
    line += fmt::format("; left out, because {}: {}", why, fmt::join(NamesOf(left), ", "));
  };
  add_left(false, "a path has no time and no temperature");
  add_left(true, "only what acts along an axis is known to move a path");
  if (!doubts_.empty()) line += fmt::format("; {}; the U95 of the map is without that", doubts_);
  return line;
}

void PathCauses::AddTo(nlohmann::ordered_json& result) const {
  if (!Active()) return;
  result["causes"] = NamesOf(causes_);
  if (!doubts_.empty()) result["causes_doubt"] = doubts_;
}

void AddPathCauses(CLI::App& command, CausesOption& option, double& feed_mm_min) {
  AddAlthough(command, option,
              command.add_option("--causes", option.path,
                                 "Extended model (abbe diagnose -o): errors of the machine that "
                                 "its map lacks"));
  command
      .add_option("--feed-mm-min", feed_mm_min,
                  "With --causes: the feed, for lag (0: at standstill at each point)")
      ->check(NonNegativeNumber());
}

nlohmann::ordered_json CauseCorrection::Data() const {
  nlohmann::ordered_json data{{"file", name_},
                              {"taken_out", NamesOf(taken_)},
                              {"left_in", NamesOf(left_)},
                              {"positions_um", ChangeJson(changes_.positions)},
                              {"gaps_um", ChangeJson(changes_.gaps)},
                              {"angles_urad", ChangeJson(changes_.angles)}};
  if (!verdict_.empty()) data["verdict"] = verdict_;
  if (doubts_.empty()) return data;
  data["doubt"] = doubts_;
  data["unexplained_um"] = unexplained_ / kMicro;
  return data;
}

}  // namespace abbe::apps
