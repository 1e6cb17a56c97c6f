#include "machine/axis_motions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "machine/volumetric_kernels.h"

namespace abbe::machine {
namespace {

using Eigen::Index;

// Up to this degree powers of t on [0, 1] lose no relevant digits.
constexpr int kMostDegree = 7;

// The degree of a form that is continuous and piecewise polynomial; else 0.
int PieceDegree(const FunctionForm& form) {
  const std::string name = form.Name();
  if (name == "table") return 1;
  if (name == "b-spline" || name == "polynomial") {
    return static_cast<int>(form.Shape().at("degree").front());
  }
  return 0;
}

// Chebyshev points of [0, 1] with both ends, so that the first coefficient is the value at t = 0.
Eigen::VectorXd Nodes(int degree) {
  Eigen::VectorXd nodes = Eigen::VectorXd::Zero(degree + 1);
  for (Index i = 1; i <= degree; ++i) {
    nodes[i] = (1 - std::cos(std::numbers::pi * i / degree)) / 2;
  }
  return nodes;
}

// The matrix from values at the nodes to coefficients of 1, t, t^2 ...
Eigen::MatrixXd CoefficientsOfValues(const Eigen::VectorXd& nodes) {
  Eigen::MatrixXd powers(nodes.size(), nodes.size());
  for (Index k = 0; k < nodes.size(); ++k) {
    powers.col(k) = nodes.array().pow(static_cast<double>(k));
  }
  return powers.fullPivLu().inverse();
}

}  // namespace

AxisMotions::AxisMotions(int axis, const std::array<ErrorFunction, kMotions>& functions,
                         const Travel& travel)
    : axis_(axis),
      // An axis that the machine lacks has an empty travel and no errors.
      travel_(travel.last > travel.first ? travel : Travel{travel.first, travel.first + 1.0}),
      ends_{travel_.first, travel_.last} {
  std::vector<std::pair<int, const ErrorFunction*>> polynomials;
  for (int motion = 0; motion < kMotions; ++motion) {
    const ErrorFunction& function = functions[motion];
    if (function.form() == nullptr) continue;
    const int degree = PieceDegree(*function.form());
    if (degree < 1 || degree > kMostDegree) {
      others_.emplace_back(motion, function);
      continue;
    }
    polynomials.emplace_back(motion, &function);
    degree_ = std::max(degree_, degree);
    const std::vector<double> pieces = function.form()->Pieces(travel_.first, travel_.last);
    ends_.insert(ends_.end(), pieces.begin(), pieces.end());
  }
  std::sort(ends_.begin(), ends_.end());
  ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());

  const Eigen::VectorXd nodes = Nodes(degree_);
  const Eigen::MatrixXd of_values = CoefficientsOfValues(nodes);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(degree_ + 1, kMotions);
  for (std::size_t piece = 0; piece + 1 < ends_.size(); ++piece) {
    const double left = ends_[piece], right = ends_[piece + 1];
    per_width_.push_back(1 / (right - left));
    for (Index i = 0; i < nodes.size(); ++i) {
      const double x = i == 0 ? left : i == degree_ ? right : left + nodes[i] * (right - left);
      for (const auto& [motion, function] : polynomials) values(i, motion) = function->Evaluate(x);
    }
    Eigen::MatrixXd coefficients = of_values * values;
    coefficients.row(0) = values.row(0);
    for (Index k = 0; k <= degree_; ++k) {
      MotionCoefficients& c = coefficients_.emplace_back();
      for (int i = 0; i < kAxes; ++i) {
        c.shift[i] = coefficients(k, i);
        c.turn[i] = coefficients(k, i + kAxes);
      }
    }
  }

  const std::size_t cells = 2 * per_width_.size();
  cells_per_m_ = cells / (travel_.last - travel_.first);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const double begin = travel_.first + cell / cells_per_m_;
    const auto after = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, begin);
    first_piece_.push_back((after - ends_.begin()) - 1);
  }
}

std::size_t AxisMotions::PieceOf(double x) const {
  const auto cell = static_cast<std::size_t>((x - travel_.first) * cells_per_m_);
  std::size_t piece = first_piece_[std::min(cell, first_piece_.size() - 1)];
  while (piece + 1 < per_width_.size() && x >= ends_[piece + 1]) ++piece;
  return piece;
}

PlaceInPiece AxisMotions::PlaceOf(double x) const {
  const std::size_t piece = PieceOf(x);
  return {&coefficients_[piece * (degree_ + 1)], (x - ends_[piece]) * per_width_[piece],
          per_width_[piece]};
}

geometry::ErrorVector<double> AxisMotions::At(double x) const {
  if (!(x >= travel_.first && x <= travel_.last)) x = InTravel(travel_, axis_, x);
  const auto [c, t, per_width] = PlaceOf(x);
  const auto of = [](const MotionCoefficients& at) {
    geometry::ErrorVector<double> row;
    row << at.shift[0], at.shift[1], at.shift[2], at.turn[0], at.turn[1], at.turn[2];
    return row;
  };
  geometry::ErrorVector<double> errors = of(c[degree_]);
  for (int k = degree_ - 1; k >= 0; --k) errors = of(c[k]) + t * errors;
  for (const auto& [motion, function] : others_) errors[motion] = function.Evaluate(x);
  return errors;
}

void AxisMotions::At(std::span<const double> places, MotionBlock& values,
                     MotionBlock* slopes) const {
  std::array<PlaceInPiece, MotionBlock::kBlock> at;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double x = places[i];
    if (i > 0 && x == places[i - 1]) {
      at[i] = at[i - 1];
      continue;
    }
    at[i] = PlaceOf(x >= travel_.first && x <= travel_.last ? x : InTravel(travel_, axis_, x));
  }
  EvaluatePieces({at.data(), places.size()}, degree_, values, slopes);
  for (const auto& [motion, function] : others_) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool stays = i > 0 && places[i] == places[i - 1];
      double slope = stays && slopes != nullptr ? slopes->At(i - 1, motion) : 0.0;
      values.At(i, motion) =
          stays ? values.At(i - 1, motion)
                : function.Evaluate(places[i], slopes != nullptr ? &slope : nullptr);
      if (slopes != nullptr) slopes->At(i, motion) = slope;
    }
  }
}

}  // namespace abbe::machine
