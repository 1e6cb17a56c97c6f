#include "fusion/calibrate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/linearization.h"
#include "failure/failure.h"
#include "failure/progress.h"
#include "fusion/contradiction.h"
#include "fusion/encoder_check.h"
#include "fusion/machine_problem.h"
#include "fusion/mapping.h"
#include "fusion/row_memory.h"
#include "simulation/linkage/linkage_gaps.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using estimation::Result;
using simulation::LinkageRun;
using simulation::LinkageSimulation;

constexpr double kNoGap = std::numeric_limits<double>::quiet_NaN();
constexpr double kBadFit = 5.0;     // excess-noise factor above which encoders are checked
constexpr double kOnePlace = 1e-4;  // m
constexpr double kOneLine = 1e-3;   // second over first extent

// Too few poses, or poses that span no volume.
void RefusePoorPoses(const std::vector<LinkageRun>& runs, Index free) {
  Index poses = 0;
  for (const LinkageRun& run : runs) poses += run.poses();
  if (3 * poses < free) {
    throw InputError(fmt::format(
        "{}: {} poses give {} numbers for {} parameters; record at least {} poses, well spread",
        runs.front().name, poses, 3 * poses, free, free));
  }
  Matrix3Xd all(3, poses);
  Index at = 0;
  for (const LinkageRun& run : runs) {
    all.middleCols(at, run.poses()) = run.reference;
    at += run.poses();
  }
  const Eigen::MatrixXd off = all.colwise() - all.rowwise().mean();
  const Vector3d extent = off.jacobiSvd().singularValues() / std::sqrt(poses);
  if (extent[0] < kOnePlace) {
    throw InputError(fmt::format(
        "{}: all {} poses stand within {:.3g} mm of one place; spread them over the volume to be "
        "measured",
        runs.front().name, poses, 1e3 * extent[0]));
  }
  if (extent[1] < kOneLine * extent[0]) {
    throw InputError(fmt::format("{}: all {} poses stand on one line; move the other axes too",
                                 runs.front().name, poses));
  }
}

double ExcessOf(const estimation::SourceResult& source) {
  return source.redundancy > 0.0 ? std::sqrt(source.chi_square / source.redundancy) : 1.0;
}

double Excess(const Result& fit) {
  double chi_square = 0.0, redundancy = 0.0;
  for (const auto& source : fit.sources) {
    if (source.is_prior) continue;
    chi_square += source.chi_square;
    redundancy += source.redundancy;
  }
  return redundancy > 0.0 ? std::sqrt(std::max(1.0, chi_square / redundancy)) : 1.0;
}

class CalibrationJob {
 public:
  CalibrationJob(const machine::Chain& chain, const relm::LinkageSettings& settings,
                 const std::vector<LinkageRun>& runs, const CalibrateOptions& options)
      : settings_(settings),
        simulation_(chain, settings, relm::MakeLinkageModel(settings, options.model)),
        runs_(runs),
        options_(options) {
    if (options.mapped && (runs.size() != 1)) {
      throw InputError(fmt::format("mapping takes one recording of a grid, {} given", runs.size()));
    }
  }

  CalibrationReport Run() {
    estimation::Problem problem =
        simulation::MakeLinkageProblem(simulation_, runs_, options_.problem);
    RefusePoorPoses(runs_, estimation::Layout(problem).columns());
    CalibrationReport report;
    Steps steps(2);
    steps.Begin("fit of all poses");
    report.fit = Solve(problem);
    report.excess = Excess(report.fit);
    if (report.excess > kBadFit) CheckAllEncoders();
    CountNoise(problem, report.fit);
    report.noise = options_.problem.noise;
    if (!options_.contradict) RefuseContradiction(report.fit, report.excess);
    report.seen = Observe(problem, report.fit);
    report.calibration = From(report.fit, runs_);
    if (options_.mapped) {
      report.cell_shifts = CellShifts(
          simulation_, runs_[0], simulation::ParametersOf(report.fit.blocks, runs_[0].mounting),
          *report.calibration.mapped);
    }
    const auto before = BeforeCalibration();
    report.before = DistancesOf(All(before));
    const auto gaps = Gaps(report.calibration, runs_);
    report.after = DistancesOf(All(gaps));
    steps.Begin("poses held out");
    const auto held_out = HeldOut();
    report.held_out = DistancesOf(All(held_out));
    report.calibration.held_out_rms = report.held_out.rms;
    ListResiduals(before, gaps, held_out, Whitened(problem, report.fit), report);
    return report;
  }

 private:
  using PerRun = std::vector<Matrix3Xd>;

  Result Solve(const estimation::Problem& problem) const {
    try {
      return simulation::SolveLinkage(problem);
    } catch (const NumericalError&) {
      CheckAllEncoders();
      throw;
    }
  }

  // Fits again with the noise of each run as it is.
  void CountNoise(estimation::Problem& problem, Result& fit) {
    constexpr int kRounds = 4;
    std::vector<simulation::RunNoise>& noise = options_.problem.noise;
    noise.resize(runs_.size());
    const auto refit = [&] {
      problem = simulation::MakeLinkageProblem(simulation_, runs_, options_.problem);
      fit = Solve(problem);
    };
    for (int round = 0; round < kRounds && IsLarger(fit, noise); ++round) refit();
    if (Remember(fit, noise)) refit();
  }

  // Rows without a memory.
  static bool IsLarger(const Result& fit, std::vector<simulation::RunNoise>& noise) {
    constexpr double kNoticed = 1.05;
    bool larger = false;
    for (std::size_t r = 0; r < noise.size(); ++r) {
      const double more = ExcessOf(fit.sources[r]);
      if (!(more > kNoticed)) continue;
      noise[r].deviation *= more;
      larger = true;
    }
    return larger;
  }

  bool Remember(const Result& fit, std::vector<simulation::RunNoise>& noise) const {
    auto options = options_.problem;
    const VectorXd x = ValuesFound(fit, fit.blocks);
    for (std::size_t r = 0; r < noise.size(); ++r) {
      const simulation::LinkageGaps gaps = simulation::LinkageGaps::Evenly(simulation_, runs_[r]);
      VectorXd left(gaps.Rows());
      gaps.Evaluate(simulation::ParametersOf(fit.blocks, runs_[r].mounting), left, nullptr);
      const auto channel = [&](int i) {
        return VectorXd(left(Eigen::seq(i, Eigen::last, Eigen::fix<3>)));
      };
      const double white = estimation::WhitePart({channel(0), channel(1), channel(2)});
      options.noise[r].memory = {std::max(1.0, white), 0.0, 1.0};
    }
    const estimation::Problem white = simulation::MakeLinkageProblem(simulation_, runs_, options);
    const estimation::Layout layout(white);
    const estimation::Linearization at = estimation::Linearize(white, layout, x, 0);
    bool any = false;
    for (std::size_t r = 0; r < noise.size(); ++r) {
      if (runs_[r].one_by_one) continue;
      const RowMemory found = FindRowMemory(white, layout, x, at, r, runs_[r].time);
      if (!(found.gain > kRemembers)) continue;
      const double unit = options.noise[r].memory->white;
      noise[r].memory = {unit * found.noise.white, unit * found.noise.slow, found.noise.time};
      any = true;
    }
    return any;
  }

  void CheckAllEncoders() const {
    for (const LinkageRun& run : runs_) CheckEncoders(simulation_, run);
  }

  Calibration From(const Result& fit, const std::vector<LinkageRun>& runs) const {
    Calibration calibration;
    calibration.model = options_.model;
    calibration.displacement = options_.problem.displacement;
    calibration.mountings = simulation::MountingsOf(runs);
    calibration.blocks = fit.blocks;
    calibration.names = fit.names;
    calibration.covariance = fit.covariance;
    if (options_.mapped) {
      calibration.mapped = MapParameters(simulation_, runs[0],
                                         simulation::ParametersOf(fit.blocks, runs[0].mounting));
    }
    return calibration;
  }

  PerRun Gaps(const Calibration& calibration, const std::vector<LinkageRun>& runs) const {
    const CalibratedLinkage linkage(settings_, calibration);
    PerRun gaps;
    for (const LinkageRun& run : runs) {
      gaps.push_back(linkage.Tips(run.readings, run.mounting) - simulation_.Ball(run));
    }
    return gaps;
  }

  // Displacements of the nominal linkage: only the base position is free.
  PerRun BeforeCalibration() const {
    estimation::Problem problem =
        simulation::MakeLinkageProblem(simulation_, runs_, {.displacement = true, .loss = {}});
    for (std::size_t b = 0; b < problem.blocks().size(); ++b) {
      problem.Block({static_cast<int>(b)}).Hold();
    }
    for (const std::string& mounting : simulation::MountingsOf(runs_)) {
      problem.Block(problem.Find(simulation::BaseBlock(mounting))).Free();
    }
    Calibration nominal;
    nominal.model = options_.model;
    nominal.mountings = simulation::MountingsOf(runs_);
    nominal.displacement = true;
    nominal.blocks = simulation::SolveLinkage(problem).blocks;
    return Gaps(nominal, runs_);
  }

  PerRun HeldOut() const {
    PerRun gaps;
    for (const LinkageRun& run : runs_) {
      gaps.emplace_back(Matrix3Xd::Constant(3, run.poses(), kNoGap));
    }
    Steps steps(0);
    for (int fold = 0; options_.folds > 1 && fold < options_.folds; ++fold) {
      steps.Begin(fmt::format("fit without part {}", fold + 1));
      std::vector<LinkageRun> rest, left_out;
      std::vector<std::vector<Index>> chosen;
      for (const LinkageRun& run : runs_) {
        std::vector<Index> in, out;
        for (Index pose = 0; pose < run.poses(); ++pose) {
          (pose * options_.folds / run.poses() == fold ? out : in).push_back(pose);
        }
        rest.push_back(Selection(run, in));
        left_out.push_back(Selection(run, out));
        chosen.push_back(out);
      }
      const auto fit = simulation::SolveLinkage(
          simulation::MakeLinkageProblem(simulation_, rest, options_.problem));
      const PerRun fold_gaps = Gaps(From(fit, rest), left_out);
      for (std::size_t r = 0; r < runs_.size(); ++r) gaps[r](Eigen::all, chosen[r]) = fold_gaps[r];
    }
    return gaps;
  }

  // The rows of each run, in deviations of its noise as the fit counts it.
  static PerRun Whitened(const estimation::Problem& problem, const Result& fit) {
    PerRun white;
    estimation::VisitRows(problem, estimation::Layout(problem), ValuesFound(fit, fit.blocks), false,
                          [&](const estimation::WhitenedRows& rows) {
                            white.emplace_back(rows.r.reshaped(3, rows.r.size() / 3));
                          });
    return white;
  }

  static Matrix3Xd All(const PerRun& gaps) {
    Index poses = 0;
    for (const auto& run : gaps) poses += run.cols();
    Matrix3Xd all(3, poses);
    Index at = 0;
    for (const auto& run : gaps) {
      all.middleCols(at, run.cols()) = run;
      at += run.cols();
    }
    return all;
  }

  void ListResiduals(const PerRun& before, const PerRun& gaps, const PerRun& held_out,
                     const PerRun& white, CalibrationReport& report) const {
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      for (Index pose = 0; pose < runs_[r].poses(); ++pose) {
        report.residuals.push_back({r, pose, runs_[r].rows[pose], before[r].col(pose),
                                    gaps[r].col(pose), held_out[r].col(pose),
                                    white[r].col(pose).cwiseAbs().maxCoeff()});
      }
    }
    for (const PoseResidual& residual : report.residuals) {
      if (residual.normalised > estimation::kOutlierAt) report.outliers.push_back(residual);
    }
    std::sort(report.outliers.begin(), report.outliers.end(),
              [](const auto& a, const auto& b) { return a.normalised > b.normalised; });
  }

  const relm::LinkageSettings& settings_;
  LinkageSimulation simulation_;
  const std::vector<LinkageRun>& runs_;
  CalibrateOptions options_;
};

}  // namespace

Distances DistancesOf(const Matrix3Xd& gaps) {
  if (gaps.cols() == 0) return {kNoGap, kNoGap};
  const VectorXd squares = gaps.colwise().squaredNorm();
  return {std::sqrt(squares.mean()), std::sqrt(squares.maxCoeff())};
}

CalibrationReport Calibrate(const machine::Chain& chain, const relm::LinkageSettings& settings,
                            const std::vector<LinkageRun>& runs, const CalibrateOptions& options) {
  return CalibrationJob(chain, settings, runs, options).Run();
}

}  // namespace abbe::fusion
