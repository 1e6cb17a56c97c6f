#include "simulation/sweep/form_of_target.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "simulation/sweep/sweep_reading.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kReach = 2.0;        // lengths: there a hump is 2 % of its top
constexpr double kApart = 0.8;        // lengths, from hump to hump
constexpr double kLongest = 160.0;    // lengths, of a travel
constexpr double kSameLine = 0.1e-3;  // m
constexpr double kRoundingOfLines = 1e-9;
const estimation::PrintUnit kNanometres{"nm", 1e-9};

// The probes of one unit and the face before them.
struct Unit {
  std::string face;
  Index first, count;
};

std::array<Unit, 2> UnitsOf(const SweepRun& run) {
  return {{{"top", 0, kTopProbes},
           {run.mounted.head_turned ? "far_side" : "side", kTopProbes, probes::kSideProbes}}};
}

// The coordinates across, each once: of the head as it is made, then reversed.
class Lines {
 public:
  Lines(const probes::HeadLayout<>& layout, const Unit& unit, double length) {
    for (const double sense : {1.0, -1.0}) {
      for (Index probe = unit.first; probe < unit.first + unit.count; ++probe) {
        const double across = sense * PlaceOf(layout, static_cast<std::size_t>(probe))[1];
        if (Find(across) == std::ssize(across_)) across_.push_back(across);
      }
    }
    const Index n = std::ssize(across_);
    MatrixXd K(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index k = 0; k < n; ++k) {
        K(i, k) = FormCorrelation(std::pow(across_[i] - across_[k], 2), length);
      }
    }
    K.diagonal().array() += kRoundingOfLines;
    root_ = K.llt().matrixL();
  }

  Index Find(double across) const {
    const auto at = std::find_if(across_.begin(), across_.end(),
                                 [&](double each) { return std::abs(each - across) < kSameLine; });
    return at - across_.begin();
  }
  // One column for each line before and with this one.
  RowVectorXd Weights(Index line) const { return root_.row(line).head(line + 1); }

 private:
  std::vector<double> across_;
  MatrixXd root_;
};

// Rows along, one column for each hump from `first` on.
MatrixXd HumpsAt(const RowVectorXd& along, double length, Index first, Index count) {
  MatrixXd humps(along.size(), count);
  for (Index j = 0; j < count; ++j) {
    const double middle = kApart * static_cast<double>(first + j);
    humps.col(j) = (-(along.array() / length - middle).square()).exp().matrix().transpose();
  }
  return humps.rowwise().normalized();
}

struct Window {
  Index first, count;
};

Window WindowOf(const MatrixXd& spots, const Unit& unit, double length) {
  const auto along = spots(Eigen::seqN(2 * unit.first, unit.count, Index{2}), Eigen::all);
  const auto first = static_cast<Index>(std::floor((along.minCoeff() / length - kReach) / kApart));
  const auto last = static_cast<Index>(std::ceil((along.maxCoeff() / length + kReach) / kApart));
  return {first, last - first + 1};
}

void AddUnit(const Unit& unit, const MatrixXd& spots, const SweepInstrument& instrument,
             const SweepRun& run, FormOfTarget& form) {
  const double length = instrument.target.form_length;
  const Lines lines(instrument.head.layout, unit, length);
  const Window window = WindowOf(spots, unit, length);
  Index last = 0;
  for (Index probe = unit.first; probe < unit.first + unit.count; ++probe) {
    last = std::max(last, lines.Find(spots(2 * probe + 1, 0)));
  }
  const Index before = form.columns.cols(), rows = run.rows();
  form.columns.conservativeResize(kProbes * rows, before + (last + 1) * window.count);
  form.columns.rightCols((last + 1) * window.count).setZero();
  for (Index probe = unit.first; probe < unit.first + unit.count; ++probe) {
    const MatrixXd humps = HumpsAt(spots.row(2 * probe), length, window.first, window.count);
    const RowVectorXd weights = lines.Weights(lines.Find(spots(2 * probe + 1, 0)));
    for (Index line = 0; line < weights.size(); ++line) {
      form.columns.block(probe * rows, before + line * window.count, rows, window.count) =
          weights[line] * humps;
    }
  }
  for (Index line = 0; line <= last; ++line) {
    for (Index j = 0; j < window.count; ++j) {
      estimation::ParameterBlock& block = form.blocks.emplace_back(
          fmt::format("target_form {} {} {} {}", run.axis, unit.face, line, window.first + j),
          kNanometres, std::vector<estimation::Parameter>{});
      block.entries.push_back({.name = "height", .prior_sd = instrument.target.form});
    }
  }
}

}  // namespace

FormOfTarget FormOfTargetIn(const machine::Chain& chain, const SweepInstrument& instrument,
                            const SweepRun& run) {
  FormOfTarget form;
  if (!(instrument.target.form > 0.0)) return form;
  const MatrixXd spots = SpotsOnTarget(chain, instrument.head, run);
  for (const Unit& unit : UnitsOf(run)) {
    const auto along = spots(Eigen::seqN(2 * unit.first, unit.count, Index{2}), Eigen::all);
    if (along.maxCoeff() - along.minCoeff() > kLongest * instrument.target.form_length) return {};
  }
  for (const Unit& unit : UnitsOf(run)) AddUnit(unit, spots, instrument, run, form);
  return form;
}

}  // namespace abbe::simulation
