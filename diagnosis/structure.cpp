#include "diagnosis/structure.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "simulation/variables.h"

namespace abbe::diagnosis {

using Eigen::Index;
using Eigen::RowVectorXd;
using simulation::Disturbance;
using simulation::FactorOf;
using simulation::GapOf;
using simulation::HasFactor;
using simulation::IsGap;
using simulation::IsSpeed;
using simulation::OwnerOf;
using simulation::Scene;
using simulation::Trace;
using simulation::ValuesOf;

std::optional<Range> RangeOf(const std::string& variable, const StageChannel& channel,
                             const Scene& scene) {
  Range range;
  if (IsGap(variable) && variable != GapOf(channel.object)) return {};
  for (const Trace* trace : scene.traces) {
    if (!channel.Feels(*trace)) continue;
    const RowVectorXd values = ValuesOf(variable, *trace);
    if (values.size() == 0) continue;
    range.first = std::min(range.first, values.minCoeff());
    range.last = std::max(range.last, values.maxCoeff());
  }
  if (!(range.last > range.first)) return {};
  return range;
}

Eigen::ArrayXd Range::Scaled(const RowVectorXd& values) const {
  // Cables that are found exchanged bring values from elsewhere, where polynomials know no bounds.
  return (2.0 * (values.transpose().array() - first) / Length() - 1.0).max(-1.0).min(1.0);
}

Factors FactorsOf(const std::string& product) {
  const auto star = product.find('*');
  return {product.substr(0, star), product.substr(star + 1)};
}

Index Structure::columns() const {
  return form == Form::kLine ? 2 : form == Form::kInterval ? 1 : form == Form::kProduct ? 4 : terms;
}

Eigen::VectorXd Structure::Weights() const {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(columns());
  if (is_rough) weights.array() /= Eigen::ArrayXd::LinSpaced(columns(), 1.0, columns());
  return weights;
}

bool Structure::IsOfItself() const {
  std::string object = channel.object;
  std::ranges::transform(object, object.begin(), [](unsigned char c) { return std::tolower(c); });
  return OwnerOf(variable) == object;
}

double Structure::among() const {
  return form == Form::kLine ? kLines : form == Form::kInterval ? kIntervals : 1.0;
}

Eigen::MatrixXd Structure::FunctionsOf(const Trace& trace) const {
  if (form == Form::kProduct) return ProductsOf(trace);
  const RowVectorXd values = ValuesOf(variable, trace);
  if (values.size() == 0) return {};
  if (form == Form::kSmooth) return SmoothOf(trace, values);
  Eigen::MatrixXd functions(columns(), values.size());
  if (form == Form::kLine) {
    functions.row(0) = (wave * values.array()).sin();
    functions.row(1) = (wave * values.array()).cos();
  } else {
    functions = (values.array() >= interval.from && values.array() < interval.to).cast<double>();
  }
  return functions;
}

Eigen::MatrixXd Structure::SmoothOf(const Trace& trace, const RowVectorXd& values) const {
  const Eigen::ArrayXd at = range.Scaled(values);
  // cos(k angle) from one to the next by the angle of a step; of polynomials each from two before.
  Eigen::MatrixXd functions(terms, values.size());
  if (IsGap(variable)) {
    Eigen::ArrayXd before = Eigen::ArrayXd::Ones(at.size()), now = at;
    for (Index degree = 1; degree < from + terms; ++degree) {
      if (degree >= from) functions.row(degree - from) = now.transpose();
      const auto k = static_cast<double>(degree);
      const Eigen::ArrayXd next = ((2.0 * k + 1.0) * at * now - k * before) / (k + 1.0);
      before = std::move(now);
      now = next;
    }
  } else {
    const Eigen::ArrayXd angle = 0.5 * std::numbers::pi * (at + 1.0);
    const Eigen::ArrayXd turn = (static_cast<double>(step) * angle).cos();
    Eigen::ArrayXd now = (static_cast<double>(from) * angle).cos(),
                   before = (static_cast<double>(from - step) * angle).cos();
    for (Index i = 0; i < terms; ++i) {
      functions.row(i) = now.transpose();
      const Eigen::ArrayXd next = 2.0 * turn * now - before;
      before = std::move(now);
      now = next;
    }
  }
  const RowVectorXd factor = FactorOf(variable, trace);
  if (factor.size() > 0) functions.array().rowwise() *= factor.array();
  if (is_rough) functions = Weights().asDiagonal() * functions;
  return functions;
}

Eigen::MatrixXd Structure::ProductsOf(const Trace& trace) const {
  const auto [one, other] = FactorsOf(variable);
  const RowVectorXd values = ValuesOf(one, trace), others = ValuesOf(other, trace);
  if (values.size() == 0 || others.size() == 0) return {};
  const auto legendre = [](const Eigen::ArrayXd& v) {
    return std::array<Eigen::ArrayXd, 2>{v, 1.5 * v.square() - 0.5};
  };
  const auto first = legendre(range.Scaled(values)), last = legendre(second.Scaled(others));
  Eigen::MatrixXd functions(4, values.size());
  for (std::size_t i = 0; i < 4; ++i) {
    functions.row(static_cast<Index>(i)) = (first[i / 2] * last[i % 2]).transpose();
  }
  return functions;
}

std::vector<Disturbance> Structure::ColumnsOf(const Trace& trace) const {
  const Eigen::MatrixXd functions = channel.Feels(trace) ? FunctionsOf(trace) : Eigen::MatrixXd{};
  std::vector<Disturbance> all(static_cast<std::size_t>(columns()),
                               simulation::NoDisturbance(trace));
  for (Index i = 0; i < functions.rows(); ++i) {
    all[static_cast<std::size_t>(i)].row(channel.stage) = functions.row(i);
  }
  return all;
}

Structure SmoothIn(const StageChannel& channel, const std::string& variable, const Range& range) {
  Structure structure{.channel = channel, .variable = variable, .range = range};
  const bool has_factor = HasFactor(variable), own = structure.IsOfItself();
  if (has_factor && !own) structure.from = 0;
  if (IsSpeed(variable) && own) structure.from = structure.step = 2;
  if (IsGap(variable)) structure.from = 3;
  return structure;
}

}  // namespace abbe::diagnosis
