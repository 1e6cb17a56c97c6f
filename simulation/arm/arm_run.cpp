#include "simulation/arm/arm_run.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <map>
#include <memory>

#include "failure/failure.h"
#include "simulation/linkage/linkage_gaps.h"
#include "simulation/linkage/linkage_kinds.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

bool IsArm(const recording::Recording& recording) {
  return recording.Kind() == "linkage" && !recording.Find("x_mm") && !recording.Find("y_mm") &&
         !recording.Find("z_mm");
}

LinkageRun ReadArmRun(const recording::Recording& recording,
                      const relm::LinkageSettings& settings) {
  LinkageRun run = AtMost(MeansOfStays(ReadLinkageRun(recording, settings)), kMostDiagnosedPoses);
  if (!recording.Find("time_s")) run.time.setZero();
  const double again = settings.noise.repeatability;
  run.reference_sd = (run.reference_sd.array().square() + again * again).sqrt();
  return run;
}

namespace {

Matrix3Xd TipsOf(const relm::SerialChain& chain, const LinkageRun& run) {
  Matrix3Xd p_BT(3, run.poses());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    p_BT.col(pose) = chain.Tip(Eigen::VectorXd(run.readings.angles.col(pose)));
  }
  return p_BT;
}

// Rms along the principal directions, the largest first.
Vector3d SpreadOf(const Matrix3Xd& places) {
  const Matrix3Xd off = places.colwise() - places.rowwise().mean().eval();
  const Eigen::Matrix3d square = off * off.transpose() / places.cols();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(square)
      .eigenvalues()
      .cwiseMax(0.0)
      .cwiseSqrt()
      .reverse();
}

// By how far the ball sits off the nominal one, in B at zero angles: the hand turns it along.
Vector3d OffsetSeen(const relm::LinkageSettings& placed, const LinkageRun& run) {
  const Matrix3Xd nominal = TipsOf(placed.chain, run);
  Eigen::MatrixXd by_offset(nominal.size(), 3);
  for (Index k = 0; k < 3; ++k) {
    const relm::SerialChain moved(placed.chain.axes(), placed.chain.tip() + Vector3d::Unit(k));
    by_offset.col(k) = (placed.X_MB.R * (TipsOf(moved, run) - nominal)).reshaped();
  }
  const Matrix3Xd gap = run.reference - ((placed.X_MB.R * nominal).colwise() + placed.X_MB.p);
  const Eigen::VectorXd offset =
      by_offset.completeOrthogonalDecomposition().solve(Eigen::VectorXd(gap.reshaped()));
  return offset;
}

// What the entries of block "ball" move the ball by, in B at zero angles, and where they stand in x.
struct BallEntries {
  Eigen::Matrix3d directions;
  Index first = 0;
};

BallEntries BallOf(const LinkageSimulation& arm) {
  BallEntries ball;
  for (const auto& block : arm.Blocks()) {
    if (block.name == BallBlock("")) break;
    ball.first += block.size();
  }
  const auto zero = arm.model().Differentiate(Eigen::VectorXd::Zero(arm.model().joints()), 0.0,
                                              arm.model().Values());
  ball.directions = zero.J_tip_x.middleCols<3>(ball.first - LinkageSimulation::kBase);
  return ball;
}

// The base where the arm fits best what the instrument saw, its ball `offset` off.
void PlaceBase(const LinkageRun& run, const Vector3d& offset, relm::LinkageSettings& settings) {
  const relm::SerialChain chain(settings.chain.axes(), settings.chain.tip() + offset);
  const Matrix3Xd p_BT = TipsOf(chain, run);
  const Vector3d down_B = settings.DownB(), spread = SpreadOf(p_BT);
  if (spread[0] > kTooNear && spread[1] < kTooNear) {
    throw InputError(fmt::format(
        "{}: its {} poses lie on one line, {:.0f} mm rms along it and {:.0f} mm across: where the "
        "instrument stands cannot be determined; record poses that spread",
        run.name, run.poses(), 1e3 * spread[0], 1e3 * spread[1]));
  }
  if (spread[1] > kTooNear) {
    settings.X_MB.R = Eigen::umeyama(p_BT, run.reference, false).topLeftCorner<3, 3>();
  }
  const Vector3d middle = p_BT.rowwise().mean();
  settings.X_MB.p = run.reference.rowwise().mean() - settings.X_MB.R * middle;
  settings.down_M = settings.X_MB.R * down_B;
}

}  // namespace

relm::LinkageSettings Placed(relm::LinkageSettings settings, const LinkageRun& run) {
  constexpr int kSteps = 50;  // base and ball by turns
  PlaceBase(run, Vector3d::Zero(), settings);
  for (int step = 0; step < kSteps && !run.ball.empty(); ++step) {
    PlaceBase(run, OffsetSeen(settings, run), settings);
  }
  settings.tolerance.base_position = kAnywhere;
  settings.tolerance.base_angle = kAnyTurn;
  settings.tolerance.compliance = 0.0;
  settings.tolerance.weight = kLight;
  return settings;
}

std::string BallBlock(const std::string& ball) { return ball.empty() ? "ball" : "ball " + ball; }

Vector3d BallSeen(const relm::LinkageSettings& placed, const LinkageRun& run) {
  if (run.ball.empty()) return Vector3d::Zero();
  return BallOf(ArmSimulation(placed)).directions.transpose() * OffsetSeen(placed, run);
}

Eigen::VectorXd StartAt(const LinkageSimulation& arm, const Vector3d& ball) {
  Eigen::VectorXd x = arm.Values();
  x.segment<3>(BallOf(arm).first) = ball;
  return x;
}

relm::LinkageSettings HeldAtOnePlace(relm::LinkageSettings placed, const LinkageRun& run) {
  if (SpreadOf(run.reference)[0] > kTooNear) return placed;
  auto& held = placed.tolerance;
  held.base_angle = held.link = held.ball = held.pivot_angle = held.pivot_offset = 0.0;
  held.encoder_offset = 0.0;
  return placed;
}

LinkageSimulation ArmSimulation(const relm::LinkageSettings& placed) {
  // The axes of this chain stand where the instrument says.
  return {machine::Chain::Parse("[w b X Y Z t]"), placed,
          relm::MakeLinkageModel(placed, relm::ErrorModel::kComplete)};
}

SimulatedRun SimulateArm(const LinkageSimulation& arm, const LinkageRun& run,
                         const Eigen::VectorXd& x, double excess) {
  SimulatedRun simulated{run.name, "linkage", arm.Blocks(), nullptr};
  simulated.blocks[0].name = BaseBlock(run.mounting);
  simulated.blocks[1].name = BaseTurnBlock(run.mounting);
  Index next = 0;
  for (auto& block : simulated.blocks) {
    for (auto& entry : block.entries) entry.value = x[next++];
    if (block.name != BallBlock("") || run.ball.empty()) continue;
    block.name = BallBlock(run.ball);
    block.Free();
    for (auto& entry : block.entries) entry.prior_sd = kAnywhere;
  }
  const auto gaps = std::make_shared<LinkageGaps>(arm, run, excess);
  simulated.residual = simulated.response = gaps;
  simulated.in_space = [gaps](const Eigen::VectorXd& rows) { return gaps->InSpace(rows); };
  return simulated;
}

estimation::Problem ArmProblem(const std::vector<SimulatedRun>& runs) {
  if (runs.empty()) throw InputError("no recording of an arm; name at least one");
  estimation::Problem problem;
  std::map<std::string, estimation::BlockId> known;
  for (const SimulatedRun& run : runs) {
    std::vector<estimation::Input> inputs;
    for (const auto& block : run.blocks) {
      auto at = known.find(block.name);
      if (at == known.end()) at = known.emplace(block.name, problem.Add(block)).first;
      inputs.emplace_back(at->second);
    }
    problem.Add(problem.AddSource(run.name, {.loss = run.loss}), run.residual, inputs, 1.0);
  }
  return problem;
}

}  // namespace abbe::simulation
