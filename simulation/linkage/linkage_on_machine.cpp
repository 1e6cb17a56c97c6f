#include "simulation/linkage/linkage_on_machine.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "machine/volumetric_jacobian.h"
#include "simulation/axes_in_travel.h"
#include "simulation/linkage/gap_response.h"
#include "simulation/linkage/linkage_cells.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kMostPoses = 4096, kSample = 1024;  // in a fit
constexpr double kFewestCells = 16.0;               // along a travel
constexpr double kLeastGap = 5e-3;                  // m: what no tolerance explains
constexpr auto kLoss = estimation::RobustLoss::Huber(kHuberThreshold);

class LinkageOnMachine : public Responsive {
 public:
  // `seated`: with the seat of the ball among the parameters.
  LinkageOnMachine(machine::VolumetricModel model, Vector3d ball, LinkageSimulation linkage,
                   LinkageRun run, bool seated)
      : model_(std::move(model)),
        ball_(std::move(ball)),
        linkage_(std::move(linkage)),
        run_(std::move(run)),
        seated_(seated),
        noise_(linkage_.GapNoise(run_)),
        constant_(Matrix3Xd::Zero(3, run_.poses())) {
    run_.commanded = AxesInTravel(model_, run_.commanded, run_.name, run_.rows);
  }

  Index Rows() const override { return 3 * run_.poses(); }

  auto Noise(Index pose) const {
    return noise_.middleCols<3>(3 * pose).triangularView<Eigen::Lower>();
  }

  const LinkageRun& run() const { return run_; }

  // What is left of the gaps, not whitened.
  Matrix3Xd Left(const VectorXd& x) const {
    machine::VolumetricModel model = model_;
    model.SetParameters(x.tail(model_.ParameterCount()));
    Matrix3Xd left;
    linkage_.Gap(run_, x.head(linkage_.parameters()), left);
    left -= model.Errors(run_.commanded, ball_);
    left.colwise() -= SeatOf(x);
    return left + constant_;
  }

  // Turns the angles of each pose until x closes its gap, and adds `left` as a constant: at x the
  // same gap, with derivatives that do not know the noise of the angles (linkage_on_machine.h).
  void Recentre(const VectorXd& x, const Matrix3Xd& left) {
    constant_.setZero();
    CloseGaps(x);
    constant_ = left - Left(x);
  }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index own = linkage_.parameters(), machine = model_.ParameterCount();
    const Vector3d seat = SeatOf(x);
    machine::VolumetricModel model = model_;
    model.SetParameters(x.tail(machine));
    Matrix3Xd gap;
    estimation::RowMatrix J;
    linkage_.Gap(run_, x.head(own), gap, jacobian == nullptr ? nullptr : &J);
    for (Index pose = 0; pose < run_.poses(); ++pose) {
      const auto lower = Noise(pose);
      Vector3d left = gap.col(pose) + constant_.col(pose) - seat;
      if (jacobian == nullptr) {
        left -= model.Error(run_.commanded.col(pose), ball_);
      } else {
        const auto at = model.Linearize(run_.commanded.col(pose), ball_);
        left -= at.error;
        auto rows = jacobian->middleRows<3>(3 * pose);
        rows.leftCols(own) = J.middleRows<3>(3 * pose);
        if (seated_) rows.middleCols<3>(own) = -Eigen::Matrix3d::Identity();
        rows.rightCols(machine) = -at.J_error_parameters;
        lower.solveInPlace(rows);
      }
      values.segment<3>(3 * pose) = lower.solve(left);
    }
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override;

 private:
  // The place of the ball against the spindle, in M.
  Vector3d SeatOf(const VectorXd& x) const {
    return seated_ ? Vector3d(x.segment<3>(linkage_.parameters())) : Vector3d::Zero();
  }

  void CloseGaps(const VectorXd& x) {
    constexpr int kSteps = 2;  // the first one leaves 1e-6 of the gap
    const VectorXd own = x.head(linkage_.parameters());
    const VectorXd values = own.tail(linkage_.model().parameters());
    const Eigen::Matrix3d R = BaseAt(linkage_.settings().X_MB, own.head<6>()).R;
    const VectorXd& warmth = run_.readings.warmth;
    for (int step = 0; step < kSteps; ++step) {
      const Matrix3Xd left = Left(x);
      for (Index pose = 0; pose < run_.poses(); ++pose) {
        auto angles = run_.readings.angles.col(pose);
        const auto at =
            linkage_.model().Differentiate(angles, warmth.size() == 0 ? 0.0 : warmth[pose], values);
        const Eigen::MatrixXd J = R * at.J_tip_q;
        angles -= J.completeOrthogonalDecomposition().solve(Vector3d(left.col(pose)));
      }
    }
  }

  machine::VolumetricModel model_;
  Vector3d ball_;
  LinkageSimulation linkage_;
  LinkageRun run_;
  bool seated_;
  Matrix3Xd noise_, constant_;
};

std::shared_ptr<const Response> LinkageOnMachine::At(const VectorXd& x) const {
  const Index own = linkage_.parameters(), pivots = run_.readings.angles.rows();
  machine::VolumetricModel model = model_;
  model.SetParameters(x.tail(model_.ParameterCount()));
  const Eigen::Matrix3d R_MB = BaseAt(linkage_.settings().X_MB, x.head<6>()).R;
  const VectorXd of_linkage = x.segment(6, own - 6);
  // Where the machine and the ball in its cap bring the ball, less where the linkage finds it.
  Eigen::MatrixXd by_stage = Eigen::MatrixXd::Zero(Rows(), kStages + pivots);
  for (Index pose = 0; pose < run_.poses(); ++pose) {
    const Vector3d command = run_.commanded.col(pose);
    const auto machine =
        machine::VolumetricErrorAndJacobian(model.chain(), command, ball_, model.Motions(command));
    const double warmth = run_.readings.warmth.size() == 0 ? 0.0 : run_.readings.warmth[pose];
    const auto tip =
        linkage_.model().Differentiate(run_.readings.angles.col(pose), warmth, of_linkage);
    auto rows = by_stage.middleRows<3>(3 * pose);
    rows.leftCols<kToolStage>() = machine.J_error_motions;
    rows.middleCols<3>(kToolStage).setIdentity();
    rows.middleCols<3>(kTipStage) = -R_MB;
    rows.rightCols(pivots) = R_MB * tip.J_tip_q;
    Noise(pose).solveInPlace(rows);
  }
  return std::make_shared<GapResponse>(std::move(by_stage), run_.readings.angles);
}

// The commanded position is where the ball is meant to be, as well as it repeats there.
LinkageRun Given(LinkageRun run, const LinkageSimulation& linkage) {
  run.reference = run.commanded;
  run.reference_sd.setConstant(linkage.settings().noise.repeatability);
  return run;
}

// A quarter of the correlation length, if the knots of the functions are half of it apart; on a
// machine of many such cells, as many as a fit takes.
double CellOf(const machine::VolumetricModel& model) {
  double cell = std::numeric_limits<double>::infinity(), volume = 1.0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const auto& [first, last] = model.travels()[axis];
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

// All poses at x, gathered into cells; one that does not fit x counts with the weight of its loss.
std::shared_ptr<const LinkageOnMachine> Gather(const machine::VolumetricModel& model,
                                               const Vector3d& ball,
                                               const LinkageSimulation& linkage,
                                               const LinkageParts& parts, bool seated,
                                               const VectorXd& x) {
  CellMeans means(CellOf(model));
  parts([&](const LinkageRun& part) {
    const LinkageOnMachine poses(model, ball, linkage, Given(part, linkage), seated);
    const Matrix3Xd left = poses.Left(x);
    for (Index i = 0; i < left.cols(); ++i) {
      const Vector3d white = poses.Noise(i).solve(Vector3d(left.col(i)));
      means.Add(poses.run(), i, left.col(i), kLoss.Weight(white.cwiseAbs().maxCoeff()));
    }
  });
  auto cells = std::make_shared<LinkageOnMachine>(model, ball, linkage, means.Run(), seated);
  cells->Recentre(x, means.Gaps());
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
  const double count = std::sqrt(run.poses());
  if (gap.norm() <= kShare * way.norm() || gap.norm() / count < kLeastGap) return;
  throw InputError(fmt::format(
      "{}: the ball of the linkage and the axes go different ways, {:.1f} mm rms apart over {:.1f} "
      "mm rms of way; the chain {} or [linkage] of the machine file is not that of the recording",
      run.name, 1e3 * gap.norm() / count, 1e3 * way.norm() / count, chain.Text()));
}

// Without its residual. `seat`: deviation of the ball against the spindle; 0: it has no block.
SimulatedRun WithBlocks(const machine::VolumetricModel& model, const LinkageSimulation& linkage,
                        const LinkageRun& run, double seat) {
  SimulatedRun simulated{run.name, "linkage", linkage.Blocks(), nullptr, kLoss};
  simulated.blocks[0].name = BaseBlock(run.mounting);
  simulated.blocks[1].name = BaseTurnBlock(run.mounting);
  if (seat > 0.0) {
    simulated.blocks.push_back({"ball_seat " + run.name,
                                {"um", 1e-6},
                                {{.name = "x", .prior_sd = seat},
                                 {.name = "y", .prior_sd = seat},
                                 {.name = "z", .prior_sd = seat}}});
  }
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  return simulated;
}

}  // namespace

SimulatedRun SimulateLinkage(const machine::VolumetricModel& model, const Vector3d& reference,
                             const LinkageSimulation& linkage, const LinkageParts& parts) {
  const auto [sample, all] = SampleOf(parts, kMostPoses, kSample);
  const LinkageRun fitted = Given(sample, linkage);
  const double seat = linkage.settings().tolerance.seat;
  const bool seated = seat > 0.0;
  SimulatedRun simulated = WithBlocks(model, linkage, fitted, seat);
  RefuseOtherChain(linkage, fitted, model.chain());
  const auto residual =
      std::make_shared<LinkageOnMachine>(model, -reference, linkage, fitted, seated);
  simulated.residual = simulated.response = residual;
  if (all == fitted.poses()) {
    simulated.heading = HeadingsOf(fitted.commanded);
    simulated.commanded = fitted.commanded;
    if (!fitted.one_by_one) simulated.times = fitted.time;
  }
  simulated.condense = [=, gathers = all > fitted.poses()](const VectorXd& x) {
    if (gathers) return Gather(model, -reference, linkage, parts, seated, x);
    auto recentred = std::make_shared<LinkageOnMachine>(*residual);
    recentred->Recentre(x, residual->Left(x));
    return std::shared_ptr<const LinkageOnMachine>(recentred);
  };
  return simulated;
}

SimulatedRun SimulateLinkage(const machine::VolumetricModel& model, const Vector3d& reference,
                             const LinkageSimulation& linkage, const LinkageRun& run) {
  return SimulateLinkage(model, reference, linkage,
                         [run](const std::function<void(const LinkageRun&)>& use) { use(run); });
}

SimulatedRun SimulateStandingLinkage(const machine::VolumetricModel& model,
                                     const Vector3d& reference, const LinkageSimulation& linkage,
                                     const LinkageRun& run) {
  const double seat =
      std::hypot(linkage.settings().tolerance.seat, linkage.settings().noise.repeatability);
  SimulatedRun simulated = WithBlocks(model, linkage, run, seat);
  const auto residual =
      std::make_shared<LinkageOnMachine>(model, -reference, linkage, run, seat > 0.0);
  simulated.residual = simulated.response = residual;
  return simulated;
}

}  // namespace abbe::simulation
