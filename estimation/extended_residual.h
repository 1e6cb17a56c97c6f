// A residual with linear terms beside its own: base(x) - always - columns * (the last of x).
//
//   const auto extended = std::make_shared<ExtendedResidual>(residual, always, columns);
//
// Units: those of the base. Shapes: `always` rows of the base, `columns` rows x coefficients; x is
// that of the base followed by the coefficients.
// Failure: that of the base.
// Validity: linear in the coefficients.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "estimation/residual.h"

namespace abbe::estimation {

class ExtendedResidual : public Residual {
 public:
  ExtendedResidual(std::shared_ptr<const Residual> base, Eigen::VectorXd always,
                   Eigen::MatrixXd columns)
      : base_(std::move(base)), always_(std::move(always)), columns_(std::move(columns)) {}

  Eigen::Index Rows() const override { return base_->Rows(); }
  const std::shared_ptr<const Residual>& base() const { return base_; }
  const Eigen::MatrixXd& columns() const { return columns_; }

  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                RowMatrix* jacobian) const override {
    const Eigen::Index own = x.size() - columns_.cols();
    if (jacobian == nullptr) {
      base_->Evaluate(x.head(own), values, nullptr);
    } else {
      RowMatrix of_base(Rows(), own);
      base_->Evaluate(x.head(own), values, &of_base);
      jacobian->leftCols(own) = of_base;
      jacobian->rightCols(columns_.cols()) = -columns_;
    }
    values -= always_ + columns_ * x.tail(columns_.cols());
  }

 private:
  std::shared_ptr<const Residual> base_;
  Eigen::VectorXd always_;
  Eigen::MatrixXd columns_;
};

}  // namespace abbe::estimation
