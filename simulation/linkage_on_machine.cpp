#include "simulation/linkage_on_machine.h"

#include <Eigen/Dense>
#include <utility>

#include "simulation/axes_in_travel.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

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

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index own = linkage_.parameters(), machine = model_.ParameterCount();
    machine::VolumetricModel model = model_;
    model.SetParameters(x.tail(machine));
    Matrix3Xd gap;
    estimation::RowMatrix J;
    linkage_.Gap(run_, x.head(own), gap, jacobian == nullptr ? nullptr : &J);
    for (Index pose = 0; pose < run_.poses(); ++pose) {
      const auto lower = noise_.middleCols<3>(3 * pose).triangularView<Eigen::Lower>();
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

}  // namespace

SimulatedRun SimulateLinkage(const machine::VolumetricModel& model, const Vector3d& reference,
                             const LinkageSimulation& linkage, const LinkageRun& run) {
  LinkageRun commanded = run;
  commanded.reference = run.commanded;
  commanded.reference_sd.setConstant(linkage.settings().noise.repeatability);
  SimulatedRun simulated{run.name, "linkage", linkage.Blocks(), nullptr,
                         estimation::RobustLoss::Huber(kPullsNoMore)};
  simulated.blocks[0].name = BaseBlock(run.mounting);
  simulated.blocks[1].name = BaseTurnBlock(run.mounting);
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  simulated.residual =
      std::make_shared<LinkageOnMachine>(model, -reference, linkage, std::move(commanded));
  return simulated;
}

}  // namespace abbe::simulation
