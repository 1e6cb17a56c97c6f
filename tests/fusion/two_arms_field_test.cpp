// The estimator on chains of six joints that nobody of this project built: the two arms of a robot,
// measured by a laser tracker over a grid of 0.3 m.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../folders.h"
#include "fusion/calibrate.h"
#include "settings/document.h"
#include "tests/relm/arm_rows.h"

namespace abbe::fusion {
namespace two_arms_field_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::LinkageRun;

// The rows that the data's README gives, the first (the torso) at rest; its angle is + for the right
// arm. Priors: a casting of a metre, the tool and the tracker anywhere within some decimetres.
std::vector<ArmRow> RowsOf(double torso_deg) {
  return {{-90, -263, 0, torso_deg, true},
          {0, 1415.9, 150, -90},
          {-90, 0, 614, 180},
          {0, 0, 200, -90},
          {0, -640, 0, 90},
          {-90, 0, 30, 90},
          {0, 200, 0, 0}};
}

constexpr char kArm[] = R"(
bearing_harmonics = []
graduation_harmonics = []
[linkage.base]
position_mm = [0.0, 0.0, 0.0]
[linkage.tolerance]
link_um = 500000
ball_um = 500000
pivot_urad = 5000
pivot_um = 2000
encoder_offset_urad = 20000
eccentricity_urad = 0
graduation_urad = 0
bearing_um = 0
compliance_urad = 0
thermal_ppm_per_c = 0
base_um = 500000
base_urad = 1000000
[linkage.noise]
encoder_urad = 20.0
reference_um = 30.0
)";

relm::LinkageSettings ArmSettings(double torso_deg) {
  const std::string text = "[linkage]\n" + RowsText(RowsOf(torso_deg)) + kArm;
  return relm::ReadLinkageSettings(settings::Document::Parse(text, "arm.toml").Root());
}

// Joint angles in `first` ... `first` + 5 and the tracker's x, y, z at 19 ... 21 of each row.
struct ArmPoses {
  MatrixXd angles;
  Matrix3Xd positions;
};

ArmPoses ReadArm(const std::filesystem::path& path, int first) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::stringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  ArmPoses poses{MatrixXd(6, static_cast<Index>(rows.size())),
                 Matrix3Xd(3, static_cast<Index>(rows.size()))};
  for (Index pose = 0; pose < poses.positions.cols(); ++pose) {
    const auto& row = rows[static_cast<std::size_t>(pose)];
    for (int i = 0; i < 6; ++i) poses.angles(i, pose) = row[static_cast<std::size_t>(first + i)];
    for (int i = 0; i < 3; ++i) poses.positions(i, pose) = row[static_cast<std::size_t>(19 + i)];
  }
  return poses;
}

struct Arm {
  const char* name;
  double torso_deg;
  int first;  // column of its first joint
};
void PrintTo(const Arm& arm, std::ostream* out) { *out << arm.name; }

class RobotArm : public ::testing::TestWithParam<Arm> {};

double GapRms(const Matrix3Xd& tips, const LinkageRun& run) {
  return DistancesOf(tips - run.reference).rms;
}

// The data's README reports 76 um (left) and 81 um (right) held out for a geometric model fitted by
// another program, 252 and 240 um without one; the requirement is 85 um.
TEST_P(RobotArm, GeometryReachesTheFigureOfAnotherProgram) {
  const Arm& arm = GetParam();
  const auto path = FieldData() / "motoman-leica" /
                    (std::string("leica_") + arm.name + "_hand_6x6x6_dataset_poses.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: field data not found";
  const ArmPoses poses = ReadArm(path, arm.first);
  relm::LinkageSettings settings = ArmSettings(arm.torso_deg);
  Matrix3Xd nominal(3, poses.positions.cols());
  for (Index pose = 0; pose < nominal.cols(); ++pose) {
    nominal.col(pose) = settings.chain.Tip(VectorXd(poses.angles.col(pose)));
  }
  // Where the tracker stands, but for the tool: the start of the fit.
  const Eigen::Matrix4d X = Eigen::umeyama(nominal, poses.positions, false);
  settings.X_MB = {X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>()};
  const auto chain = machine::Chain::Parse("[w b X Y Z t]");  // axis positions are positions in M
  LinkageRun run = simulation::RunAt(poses.positions, settings);
  run.readings.angles = poses.angles;
  run.one_by_one = true;  // as any table without times is read
  for (Index fold = 0; fold < 4; ++fold) {
    std::vector<Index> kept, out;
    for (Index pose = 0; pose < run.poses(); ++pose) {
      (pose % 4 == fold ? out : kept).push_back(pose);
    }
    const LinkageRun left_out = Selection(run, out);
    const auto report = Calibrate(chain, settings, {Selection(run, kept)}, {.folds = 1});
    const CalibratedLinkage arm_now(settings, report.calibration);
    const double held_out = GapRms(arm_now.Tips(left_out.readings), left_out);
    fmt::print("{} arm, every 4th pose from {}: {:.1f} um, held out {:.1f} um, excess {:.2f}\n",
               arm.name, fold, 1e6 * report.after.rms, 1e6 * held_out, report.excess);
    EXPECT_GT(report.before.rms, 200e-6) << "fold " << fold;
    EXPECT_LT(held_out, 85e-6) << "fold " << fold;
  }
}

INSTANTIATE_TEST_SUITE_P(BothArms, RobotArm,
                         ::testing::Values(Arm{"right", 15.0, 7}, Arm{"left", -15.0, 13}),
                         [](const auto& arm) { return std::string(arm.param.name); });

}  // namespace two_arms_field_test
}  // namespace abbe::fusion
