#include "fusion/model_comparison.h"

#include <array>

#include "failure/failure.h"

namespace abbe::fusion {
namespace {

using relm::ErrorModel;

struct Candidate {
  ErrorModel model;
  bool mapped;
};
constexpr std::array<Candidate, 7> kCandidates{{
    {ErrorModel::kPivots, false},
    {ErrorModel::kPublished, false},
    {ErrorModel::kPublishedWithBearing, false},
    {ErrorModel::kPublished, true},
    {ErrorModel::kPublishedWithBearing, true},
    {ErrorModel::kComplete, false},
    {ErrorModel::kComplete, true},
}};

}  // namespace

std::vector<ComparedModel> CompareModels(const machine::Chain& chain,
                                         const relm::LinkageSettings& settings,
                                         const simulation::LinkageRun& run,
                                         CalibrateOptions options) {
  std::vector<ComparedModel> rows;
  for (const Candidate& candidate : kCandidates) {
    options.model = candidate.model;
    options.mapped = candidate.mapped;
    if (settings.segments.empty() && candidate.model != ErrorModel::kComplete) continue;
    if (!settings.pivots && candidate.model == ErrorModel::kPivots) continue;
    const CalibrationReport report = Calibrate(chain, settings, {run}, options);
    if (rows.empty()) rows.push_back({"nominal", 0, report.before, report.before});
    const auto model = relm::MakeLinkageModel(settings, candidate.model);
    rows.push_back({model.name() + (candidate.mapped ? ", mapped" : ""), model.parameters(),
                    report.after, report.held_out});
  }
  return rows;
}

}  // namespace abbe::fusion
