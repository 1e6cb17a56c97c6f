#include "fusion/target_form.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kFormBlock = "target_form ";

// Another residual less what its form does: x is that of the other, then the draws.
class FormedResidual : public estimation::Residual {
 public:
  FormedResidual(std::shared_ptr<const estimation::Residual> flat, Eigen::MatrixXd form)
      : flat_(std::move(flat)), form_(std::move(form)) {}

  Index Rows() const override { return flat_->Rows(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const Index own = form_.cols(), others = x.size() - own;
    if (jacobian == nullptr) {
      flat_->Evaluate(x.head(others), values, nullptr);
    } else {
      estimation::RowMatrix J(Rows(), others);
      flat_->Evaluate(x.head(others), values, &J);
      jacobian->leftCols(others) = J;
      jacobian->rightCols(own) = -form_;
    }
    values -= form_ * x.tail(own);
  }

 private:
  std::shared_ptr<const estimation::Residual> flat_;
  Eigen::MatrixXd form_;
};

}  // namespace

bool IsForm(const estimation::ParameterBlock& block) { return block.name.starts_with(kFormBlock); }

void WithForm(simulation::SimulatedRun& run) {
  if (!run.form) return;
  const Eigen::MatrixXd columns = run.form();
  estimation::ParameterBlock block(kFormBlock + run.name, {"", 1.0}, {});
  for (Index i = 0; i < columns.cols(); ++i) block.entries.push_back({fmt::format("f{}", i)});
  run.residual = std::make_shared<FormedResidual>(run.residual, columns);
  run.blocks.push_back(std::move(block));
  SetForm(kHardlyMoreForm, run);
}

void SetForm(double k, simulation::SimulatedRun& run) {
  for (auto& block : run.blocks) {
    if (!IsForm(block)) continue;
    for (auto& entry : block.entries) entry.prior_sd = std::sqrt(k * k - 1.0);
  }
}

}  // namespace abbe::fusion
