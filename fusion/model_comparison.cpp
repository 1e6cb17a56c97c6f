#include "fusion/model_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "failure/failure.h"
#include "fusion/mapping.h"
#include "standards/circle.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using relm::ErrorModel;
using simulation::LinkageRun;

constexpr double kNoDistance = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoCircle = 0.01;  // of the radius: a larger deviation is no circle
constexpr std::array kModelsCompared{ErrorModel::kPivots, ErrorModel::kPublished,
                                     ErrorModel::kPublishedWithBearing, ErrorModel::kComplete};

class Comparison {
 public:
  Comparison(const machine::Chain& chain, const relm::LinkageSettings& settings,
             const LinkageRun& run, const std::vector<LinkageRun>& checks,
             const CalibrateOptions& options)
      : chain_(chain), settings_(settings), run_(run), checks_(checks), options_(options) {
    options_.contradict = true;
  }

  std::vector<ComparedModel> Rows() {
    for (const ErrorModel model : kModelsCompared) {
      if (settings_.segments.empty() && model != ErrorModel::kComplete) continue;
      if (!settings_.pivots && model == ErrorModel::kPivots) continue;
      Add(model);
    }
    return rows_;
  }

 private:
  void Add(ErrorModel model) {
    options_.model = model;
    options_.mapped = false;
    const CalibrationReport global = Calibrate(chain_, settings_, {run_}, options_);
    if (rows_.empty()) AddWithoutCalibration(global.before);
    const auto made = relm::MakeLinkageModel(settings_, model);
    const Index parameters = made.parameters();
    rows_.push_back(
        {made.name(), parameters, global.after, global.held_out, Checked(global.calibration)});
    // The pivots of the RELM paper were never mapped.
    if (model == ErrorModel::kPivots) return;
    options_.mapped = true;
    const CalibrationReport mapped = Calibrate(chain_, settings_, {run_}, options_);
    const Calibration one_cell = MiddleCellOf(mapped.calibration);
    rows_.push_back({made.name() + ", one cell",
                     parameters,
                     Distance(one_cell, run_),
                     {kNoDistance, kNoDistance},
                     Checked(one_cell)});
    rows_.push_back({made.name() + ", mapped", parameters, mapped.after, mapped.held_out,
                     Checked(mapped.calibration)});
  }

  // The calibration with only the middle cell of its grid.
  static Calibration MiddleCellOf(Calibration calibration) {
    MappedParameters& cells = *calibration.mapped;
    std::size_t middle = 0;
    for (auto& centres : cells.centres) {
      const std::size_t half = centres.size() / 2;
      middle = middle * centres.size() + half;
      centres = {centres[half]};
    }
    cells.values = {cells.values[middle]};
    return calibration;
  }

  simulation::LinkageSimulation Simulation() const {
    return {chain_, settings_, relm::MakeLinkageModel(settings_, options_.model)};
  }

  Matrix3Xd Gaps(const Calibration& calibration, const LinkageRun& run) const {
    return CalibratedLinkage(settings_, calibration).Tips(run.readings, run.mounting, false) -
           Simulation().Ball(run);
  }

  Distances Distance(const Calibration& calibration, const LinkageRun& run) const {
    return DistancesOf(Gaps(calibration, run));
  }

  std::vector<CheckedRun> Checked(const Calibration& calibration) const {
    std::vector<CheckedRun> checked;
    for (const LinkageRun& check : checks_) {
      const Matrix3Xd gaps = Gaps(calibration, check);
      checked.push_back({DistancesOf(gaps), CircleDeviation(Simulation().Ball(check) + gaps)});
    }
    return checked;
  }

  // The reference, and displacements of the nominal linkage.
  void AddWithoutCalibration(const Distances& before) {
    const auto simulation = Simulation();
    const Distances none{kNoDistance, kNoDistance};
    ComparedModel reference{"reference", 0, none, none, {}},
        nominal{"nominal", 0, before, before, {}};
    for (const LinkageRun& check : checks_) {
      Matrix3Xd gaps;
      simulation.Gap(check, simulation.Values(), gaps);
      gaps.colwise() -= gaps.rowwise().mean().eval();
      const Matrix3Xd ball = simulation.Ball(check);
      reference.checks.push_back({none, CircleDeviation(ball)});
      nominal.checks.push_back({DistancesOf(gaps), CircleDeviation(ball + gaps)});
    }
    rows_ = {reference, nominal};
  }

  const machine::Chain& chain_;
  const relm::LinkageSettings& settings_;
  const LinkageRun& run_;
  const std::vector<LinkageRun>& checks_;
  CalibrateOptions options_;
  std::vector<ComparedModel> rows_;
};

}  // namespace

double CircleDeviation(const Matrix3Xd& path) {
  Index still = 0;
  (path.rowwise().maxCoeff() - path.rowwise().minCoeff()).minCoeff(&still);
  const Matrix3Xd::ConstRowXpr first = path.row((still + 1) % 3),
                               second = path.row((still + 2) % 3);
  const std::vector<double> x(first.begin(), first.end()), y(second.begin(), second.end());
  try {
    const auto circle = standards::ReferenceCircle(standards::CircleKind::kLeastSquares, x, y);
    double largest = 0.0;
    for (const double each : standards::RadialDeviations(circle, x, y)) {
      largest = std::max(largest, std::abs(each));
    }
    return largest < kNoCircle * circle.radius ? largest : kNoDistance;
  } catch (const NumericalError&) {
    return kNoDistance;  // so far from a circle that the fit does not converge
  } catch (const InputError&) {
    return kNoDistance;  // a line
  }
}

std::vector<ComparedModel> CompareModels(const machine::Chain& chain,
                                         const relm::LinkageSettings& settings,
                                         const LinkageRun& run,
                                         const std::vector<LinkageRun>& checks,
                                         CalibrateOptions options) {
  return Comparison(chain, settings, run, checks, options).Rows();
}

}  // namespace abbe::fusion
