#include "fusion/model_comparison.h"

#include <array>
#include <limits>
#include <utility>

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

constexpr Distances kNone{std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::quiet_NaN()};

}  // namespace

std::vector<ComparedModel> CompareModels(const machine::Chain& chain,
                                         const relm::LinkageSettings& settings,
                                         const simulation::LinkageRun& run,
                                         CalibrateOptions options) {
  std::vector<ComparedModel> rows;
  Distances nominal = kNone;
  for (const Candidate& candidate : kCandidates) {
    options.model = candidate.model;
    options.mapped = candidate.mapped;
    if (settings.segments.empty() && candidate.model != ErrorModel::kComplete) continue;
    if (!settings.pivots && candidate.model == ErrorModel::kPivots) continue;
    const auto model = relm::MakeLinkageModel(settings, candidate.model);
    ComparedModel row{
        model.name() + (candidate.mapped ? ", mapped" : ""), model.parameters(), kNone, kNone, {}};
    try {
      const CalibrationReport report = Calibrate(chain, settings, {run}, options);
      row.after = report.after;
      row.held_out = report.held_out;
      nominal = report.before;
    } catch (const InputError& error) {
      row.why_not = error.what();
    }
    rows.push_back(std::move(row));
  }
  rows.insert(rows.begin(), {"nominal", 0, nominal, nominal, {}});
  return rows;
}

}  // namespace abbe::fusion
