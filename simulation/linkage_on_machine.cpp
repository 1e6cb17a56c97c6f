#include "simulation/linkage_on_machine.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "simulation/axes_in_travel.h"
#include "simulation/linkage_cells.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kMostPoses = 4096, kSample = 1024;  // in a fit
constexpr Index kAtOnce = 4096;                     // rows of a long run
constexpr double kFewestCells = 16.0;               // along a travel
constexpr double kLeastGap = 5e-3;                  // m: what no tolerance explains
constexpr auto kLoss = estimation::RobustLoss::Huber(kPullsNoMore);

class LinkageOnMachine : public estimation::Residual {
 public:
  LinkageOnMachine(machine::VolumetricModel model, Vector3d ball, LinkageSimulation linkage,
                   LinkageRun run)
      : model_(std::move(model)),
        ball_(std::move(ball)),
        linkage_(std::move(linkage)),
        run_(std::move(run)),
        noise_(linkage_.GapNoise(run_)) {
    run_.commanded = AxesInTravel(model_, run_.commanded, run_.name, run_.rows);
  }

  Index Rows() const override { return 3 * run_.poses(); }

  auto Noise(Index pose) const {
    return noise_.middleCols<3>(3 * pose).triangularView<Eigen::Lower>();
  }

  // What is left of the gaps, not whitened.
  Matrix3Xd Left(const VectorXd& x) const {
    machine::VolumetricModel model = model_;
    model.SetParameters(x.tail(model_.ParameterCount()));
    Matrix3Xd left;
    linkage_.Gap(run_, x.head(linkage_.parameters()), left);
    return left - model.Errors(run_.commanded, ball_);
  }

  // Turns the angles of each pose until what is left at x is `wanted`.
  void MoveAngles(const VectorXd& x, const Matrix3Xd& wanted) {
    constexpr int kSteps = 2;  // the first one leaves 1e-6 of what is moved
    const VectorXd own = x.head(linkage_.parameters());
    const VectorXd values = own.tail(linkage_.model().parameters());
    const Eigen::Matrix3d R = BaseAt(linkage_.settings().X_MB, own.head<6>()).R;
    const VectorXd& warmth = run_.readings.warmth;
    for (int step = 0; step < kSteps; ++step) {
      const Matrix3Xd missing = wanted - Left(x);
      for (Index pose = 0; pose < run_.poses(); ++pose) {
        auto angles = run_.readings.angles.col(pose);
        const auto at =
            linkage_.model().Differentiate(angles, warmth.size() == 0 ? 0.0 : warmth[pose], values);
        const Eigen::MatrixXd J = R * at.J_tip_q;
        angles += J.completeOrthogonalDecomposition().solve(Vector3d(missing.col(pose)));
      }
    }
  }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index own = linkage_.parameters(), machine = model_.ParameterCount();
    machine::VolumetricModel model = model_;
    model.SetParameters(x.tail(machine));
    Matrix3Xd gap;
    estimation::RowMatrix J;
    linkage_.Gap(run_, x.head(own), gap, jacobian == nullptr ? nullptr : &J);
    for (Index pose = 0; pose < run_.poses(); ++pose) {
      const auto lower = Noise(pose);
      Vector3d left = gap.col(pose);
      if (jacobian == nullptr) {
        left -= model.Error(run_.commanded.col(pose), ball_);
      } else {
        const auto at = model.Linearize(run_.commanded.col(pose), ball_);
        left -= at.error;
        auto rows = jacobian->middleRows<3>(3 * pose);
        rows.leftCols(own) = J.middleRows<3>(3 * pose);
        rows.rightCols(machine) = -at.J_error_parameters;
        lower.solveInPlace(rows);
      }
      values.segment<3>(3 * pose) = lower.solve(left);
    }
  }

 private:
  machine::VolumetricModel model_;
  Vector3d ball_;
  LinkageSimulation linkage_;
  LinkageRun run_;
  Matrix3Xd noise_;
};

// A quarter of the correlation length, if the knots of the functions are half of it apart; on a
// machine of many such cells, as many as a fit takes.
double CellOf(const machine::VolumetricModel& model) {
  double cell = std::numeric_limits<double>::infinity(), volume = 1.0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const auto& [first, last] = model.travels()[static_cast<std::size_t>(axis)];
    volume *= last - first;
    cell = std::min(cell, (last - first) / kFewestCells);
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const machine::SharedForm& form = model.Function(axis, motion).form();
      if (form == nullptr) continue;
      const std::vector<double> pieces = form->Pieces(first, last);
      for (std::size_t i = 1; i < pieces.size(); ++i) {
        cell = std::min(cell, (pieces[i] - pieces[i - 1]) / 2.0);
      }
    }
  }
  return std::max(cell, std::cbrt(volume / kMostPoses));
}

// All rows at x, gathered into cells; a row that does not fit x counts with the weight of its loss.
std::shared_ptr<const LinkageOnMachine> Gather(const machine::VolumetricModel& model,
                                               const Vector3d& ball,
                                               const LinkageSimulation& linkage,
                                               const LinkageRun& run, const VectorXd& x) {
  CellMeans means(run, CellOf(model));
  for (Index first = 0; first < run.poses(); first += kAtOnce) {
    std::vector<Index> poses(static_cast<std::size_t>(std::min(kAtOnce, run.poses() - first)));
    std::iota(poses.begin(), poses.end(), first);
    const LinkageOnMachine rows(model, ball, linkage, Selection(run, poses));
    const Matrix3Xd left = rows.Left(x);
    for (Index i = 0; i < left.cols(); ++i) {
      const Vector3d white = rows.Noise(i).solve(Vector3d(left.col(i)));
      means.Add(first + i, left.col(i), kLoss.Weight(white.cwiseAbs().maxCoeff()));
    }
  }
  auto cells = std::make_shared<LinkageOnMachine>(model, ball, linkage, means.Run());
  cells->MoveAngles(x, means.Gaps());
  return cells;
}

// A linkage out of its tolerances leaves gaps of a few millimetres; an axis that runs the other way
// leaves twice its travel.
void RefuseOtherChain(const LinkageSimulation& linkage, const LinkageRun& run,
                      const machine::Chain& chain) {
  constexpr double kShare = 0.2;  // of the way
  Matrix3Xd gap;
  linkage.Gap(run, linkage.Values(), gap);
  const Matrix3Xd way = run.commanded.colwise() - run.commanded.rowwise().mean().eval();
  gap.colwise() -= gap.rowwise().mean().eval();
  const double count = std::sqrt(static_cast<double>(run.poses()));
  if (gap.norm() <= kShare * way.norm() || gap.norm() / count < kLeastGap) return;
  throw InputError(fmt::format(
      "{}: the ball of the linkage and the axes go different ways, {:.1f} mm rms apart over {:.1f} "
      "mm rms of way; the chain {} or [linkage] of the machine file is not that of the recording",
      run.name, 1e3 * gap.norm() / count, 1e3 * way.norm() / count, chain.Text()));
}

}  // namespace

SimulatedRun SimulateLinkage(const machine::VolumetricModel& model, const Vector3d& reference,
                             const LinkageSimulation& linkage, LinkageRun run) {
  run.reference = run.commanded;
  run.reference_sd.setConstant(linkage.settings().noise.repeatability);
  SimulatedRun simulated{run.name, "linkage", linkage.Blocks(), nullptr, kLoss};
  simulated.blocks[0].name = BaseBlock(run.mounting);
  simulated.blocks[1].name = BaseTurnBlock(run.mounting);
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  const LinkageRun fitted = Selection(run, SampleOf(run.poses(), kMostPoses, kSample));
  RefuseOtherChain(linkage, fitted, model.chain());
  simulated.residual = std::make_shared<LinkageOnMachine>(model, -reference, linkage, fitted);
  if (fitted.poses() == run.poses()) return simulated;
  simulated.condense =
      [model, reference, linkage, all = std::make_shared<const LinkageRun>(std::move(run))](
          const VectorXd& x) { return Gather(model, -reference, linkage, *all, x); };
  return simulated;
}

}  // namespace abbe::simulation
