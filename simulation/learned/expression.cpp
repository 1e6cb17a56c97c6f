#include "simulation/learned/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/b_spline.h"
#include "simulation/variables.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

namespace {

constexpr int kCubic = 3;

// y' = (v - y) / tau, v between rows as in the row before; begins at rest.
RowVectorXd Lagged(const RowVectorXd& values, const Eigen::VectorXd& time, double tau) {
  RowVectorXd lagged = values;
  for (Index row = 1; row < values.size(); ++row) {
    const double fades = std::exp(-std::max(0.0, time[row] - time[row - 1]) / tau);
    lagged[row] = values[row] + fades * (lagged[row - 1] - values[row]);
  }
  return lagged;
}

// Output less input, in units of the width.
RowVectorXd PlayOf(const RowVectorXd& values, double width) {
  RowVectorXd play = RowVectorXd::Zero(values.size());
  double output = values[0];
  for (Index row = 0; row < values.size(); ++row) {
    output = std::clamp(output, values[row] - 0.5 * width, values[row] + 0.5 * width);
    play[row] = (output - values[row]) / width;
  }
  return play;
}

RowVectorXd Headings(const std::string& variable, const Trace& trace) {
  const std::string direction = "direction of " + variable;
  if (ValuesOf(direction, trace).size() == 0) return {};
  return FactorOf(direction, trace);
}

MatrixXd Splines(const RowVectorXd& values, const std::vector<double>& numbers) {
  const double first = numbers[0], last = numbers[1];
  const auto basis =
      geometry::BSplineBasis::Uniform(kCubic, first, last, static_cast<int>(numbers[2]) + kCubic);
  MatrixXd splines = MatrixXd::Zero(basis.size(), values.size());
  for (Index row = 0; row < values.size(); ++row) {
    const auto local = basis.At(std::clamp(values[row], first, last));
    splines.col(row).segment(local.first, local.values.size()) = local.values;
  }
  return splines;
}

}  // namespace

RowVectorXd ValuesInUnit(const std::string& variable, const Trace& trace) {
  return ValuesOf(variable, trace) / UnitOf(variable).si;
}

Index ColumnsOfAtom(const Atom& atom) {
  return atom.form == Atom::Form::kSpline ? static_cast<Index>(atom.numbers[2]) + kCubic : 1;
}

MatrixXd ValuesOfAtom(const Atom& atom, const Trace& trace, const VariableValues& values) {
  using Form = Atom::Form;
  if (atom.form == Form::kSign) return Headings(atom.variable, trace);
  const RowVectorXd v = values(atom.variable, trace);
  if (v.size() == 0) return {};
  const double number = atom.numbers.empty() ? 0.0 : atom.numbers[0];
  const double turns = 2.0 * std::numbers::pi / number;
  switch (atom.form) {
    case Form::kLinear:
    case Form::kSign:
      return v;
    case Form::kSquare:
      return v.cwiseAbs2();
    case Form::kAbsolute:
      return v.cwiseAbs();
    case Form::kSine:
      return (turns * v.array()).sin();
    case Form::kCosine:
      return (turns * v.array()).cos();
    case Form::kStep:
      return (v.array() >= number).cast<double>();
    case Form::kKink:
      return (v.array() - number).max(0.0);
    case Form::kDecay:
      return (-v.array() / number).exp();
    case Form::kLag:
      return Lagged(v, trace.time, number);
    case Form::kPlay:
      return PlayOf(v, number);
    case Form::kSpline:
      return Splines(v, atom.numbers);
  }
  return {};
}

Index Expression::columns() const {
  Index count = 0;
  for (const Product& term : terms) count += ColumnsOfAtom(term.front());
  return count;
}

MatrixXd Expression::Of(const Trace& trace, const VariableValues& values) const {
  MatrixXd functions(columns(), trace.rows());
  Index first = 0;
  for (const Product& term : terms) {
    MatrixXd product = ValuesOfAtom(term.front(), trace, values);
    for (std::size_t i = 1; i < term.size() && product.size() > 0; ++i) {
      const MatrixXd other = ValuesOfAtom(term[i], trace, values);
      if (other.size() == 0) {
        product.resize(0, 0);
      } else {
        product.row(0).array() *= other.row(0).array();
      }
    }
    if (product.size() == 0) return {};
    functions.middleRows(first, product.rows()) = product;
    first += product.rows();
  }
  return functions;
}

std::vector<std::string> Expression::Variables() const {
  std::vector<std::string> variables;
  for (const Product& term : terms) {
    for (const Atom& atom : term) {
      if (std::ranges::find(variables, atom.variable) == variables.end()) {
        variables.push_back(atom.variable);
      }
    }
  }
  return variables;
}

std::string TextOf(const Atom& atom) {
  using Form = Atom::Form;
  const std::string& v = atom.variable;
  const auto less = [&] {
    const double number = atom.numbers[0];
    return number == 0.0  ? v
           : number < 0.0 ? fmt::format("{} + {}", v, -number)
                          : fmt::format("{} - {}", v, number);
  };
  switch (atom.form) {
    case Form::kLinear:
      return v;
    case Form::kSquare:
      return v + "^2";
    case Form::kAbsolute:
      return fmt::format("abs({})", v);
    case Form::kSine:
      return fmt::format("sin(2 pi {} / {})", v, atom.numbers[0]);
    case Form::kCosine:
      return fmt::format("cos(2 pi {} / {})", v, atom.numbers[0]);
    case Form::kStep:
      return fmt::format("step({})", less());
    case Form::kKink:
      return fmt::format("max(0, {})", less());
    case Form::kDecay:
      return fmt::format("exp(-{} / {})", v, atom.numbers[0]);
    case Form::kLag:
      return fmt::format("lag({}, {})", v, atom.numbers[0]);
    case Form::kPlay:
      return fmt::format("play({}, {})", v, atom.numbers[0]);
    case Form::kSign:
      return fmt::format("sign({})", v);
    case Form::kSpline:
      return fmt::format("bspline({}, {}, {}, {})", v, atom.numbers[0], atom.numbers[1],
                         atom.numbers[2]);
  }
  return "";
}

std::string TextOf(const Product& product) {
  std::string text;
  for (const Atom& atom : product) text += (text.empty() ? "" : " * ") + TextOf(atom);
  return text;
}

std::string Expression::Text() const {
  std::string text;
  for (const Product& term : terms) text += (text.empty() ? "" : " + ") + TextOf(term);
  return text;
}

}  // namespace abbe::simulation
