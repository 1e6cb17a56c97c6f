// A residual with derivatives by automatic differentiation (dual numbers of Ceres).
//
// Background: the model is written once as a template over its number type; evaluated with dual
// numbers (value plus derivatives) instead of doubles it returns the values and their exact
// derivatives, without step sizes and without algebra.
//
//   struct Decay {                                   // x = [amplitude rate]
//     std::vector<double> time, reading;
//     template <class T>
//     void operator()(const T* x, T* values) const {
//       for (std::size_t i = 0; i < time.size(); ++i) {
//         values[i] = x[0] * exp(-x[1] * time[i]) - reading[i];
//       }
//     }
//   };
//   problem.Add(source, MakeAutoDiffResidual<2>(Decay{t, y}, t.size()), {decay}, 1e-6);
//
// The first template argument is the number of derivatives carried at once: the number of
// parameters where it is known and below some 30, else 8 to 16 (the model is then evaluated several
// times).
// Cost: each model costs about 3 s of compilation. Include it from few .cpp files, never from a
// public header.
// Units: the model's. Shapes: x as the inputs in the problem, values rows x 1, jacobian rows x
// x.size().
// Failure: that of the model's operator(); see residual.h.
// Source: forward dual numbers, ceres::Jet of the Ceres Solver.
// Validity: exact to rounding where the model is differentiable; a branch that depends on x
// differentiates the side taken.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "estimation/residual.h"

namespace abbe::estimation {

template <class Model, int kAtOnce>
class AutoDiffResidual : public Residual {
 public:
  AutoDiffResidual(Model model, Eigen::Index rows) : model_(std::move(model)), rows_(rows) {}

  // As given.
  Eigen::Index Rows() const override { return rows_; }

  // Without `jacobian` the model runs once, on doubles.
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                RowMatrix* jacobian) const override {
    if (jacobian == nullptr) {
      model_(x.data(), values.data());
      return;
    }
    std::vector<Jet> inputs(x.size());
    std::vector<Jet> outputs(rows_);
    for (Eigen::Index i = 0; i < x.size(); ++i) inputs[i] = Jet(x[i]);
    for (Eigen::Index first = 0; first < x.size(); first += kAtOnce) {
      const Eigen::Index count = std::min<Eigen::Index>(kAtOnce, x.size() - first);
      Seed(inputs, first, count, 1.0);
      model_(inputs.data(), outputs.data());
      Seed(inputs, first, count, 0.0);
      for (Eigen::Index row = 0; row < rows_; ++row) {
        const Jet& output = outputs[row];
        values[row] = output.a;
        jacobian->row(row).segment(first, count) = output.v.head(count).transpose();
      }
    }
  }

 private:
  using Jet = ceres::Jet<double, kAtOnce>;

  static void Seed(std::vector<Jet>& inputs, Eigen::Index first, Eigen::Index count, double slope) {
    for (Eigen::Index i = 0; i < count; ++i) {
      inputs[first + i].v[i] = slope;
    }
  }

  Model model_;
  Eigen::Index rows_;
};

// A shared residual; `rows`: how many values the model writes.
template <int kAtOnce, class Model>
std::shared_ptr<const Residual> MakeAutoDiffResidual(Model model, std::size_t rows) {
  return std::make_shared<AutoDiffResidual<Model, kAtOnce>>(std::move(model), rows);
}

}  // namespace abbe::estimation
