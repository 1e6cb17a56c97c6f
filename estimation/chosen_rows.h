// A selection of the rows of another residual; the others are held out.
//
//   const auto some = std::make_shared<ChosenRows>(all, rows);
//
// Units: those of the other residual. Shapes: `rows` are indices from 0 into the other residual;
// the result keeps their order.
// Cost: that of all rows.
// Failure: that of the other residual.
// Validity: for rows that are independent, as whitened ones are.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "estimation/residual.h"

namespace abbe::estimation {

class ChosenRows : public Residual {
 public:
  ChosenRows(std::shared_ptr<const Residual> all, std::vector<Eigen::Index> rows)
      : all_(std::move(all)), rows_(std::move(rows)) {}

  // As many as were chosen.
  Eigen::Index Rows() const override { return rows_.size(); }

  // All rows are evaluated, the chosen ones kept.
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                RowMatrix* jacobian) const override {
    Eigen::VectorXd all(all_->Rows());
    RowMatrix J(jacobian == nullptr ? 0 : all_->Rows(), x.size());
    all_->Evaluate(x, all, jacobian == nullptr ? nullptr : &J);
    values = all(rows_);
    if (jacobian != nullptr) *jacobian = J(rows_, Eigen::all);
  }

 private:
  std::shared_ptr<const Residual> all_;
  std::vector<Eigen::Index> rows_;
};

}  // namespace abbe::estimation
