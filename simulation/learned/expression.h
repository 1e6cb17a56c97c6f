// An expression of recorded variables, with a coefficient before each of its terms, as text.
//
//   const Expression step = ParseExpression("step(x - 31.4)");
//   const Eigen::MatrixXd functions = step.Of(trace);     // one row a coefficient
//   step.Text();                                          // "step(x - 31.4)"
//
// expression = product (" + " product)*,  product = atom (" * " atom)*,  atoms of a variable v:
//   v   v^2   abs(v)   sin(2 pi v / P)   cos(2 pi v / P)   step(v - v0): 1 from v0 on, else 0
//   max(0, v - v0)   exp(-v / tau)   lag(v, tau): v after a first-order lag of tau seconds
//   play(v, w): output less input of a play of the width w, in units of w
//   sign(v): which way an axis or a pivot last moved
//   bspline(v, a, b, n): the n + 3 cubic B-splines of n equal parts from a to b, alone in its term
// Variables are those of simulation/variables.h; a number counts in the unit in which they are
// printed: mm, mm/min, rad, s, K, um, and a column of the user's as it is.
// Units: of a product, that of its variables. Shapes: one row a coefficient, one column a row of
// the run; no rows where the run lacks a variable.
// Failure: InputError that says what is wrong in the text.
// Source: play: Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989).
// Validity: lag and play begin anew with each run, at rest.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "simulation/trace.h"

namespace abbe::simulation {

struct Atom {
  enum class Form : unsigned char {
    kLinear,
    kSquare,
    kAbsolute,
    kSine,
    kCosine,
    kStep,
    kKink,
    kDecay,
    kLag,
    kPlay,
    kSign,
    kSpline
  };

  Form form = Form::kLinear;
  std::string variable;
  std::vector<double> numbers = {};  // P, v0, tau, w; a, b, n

  friend bool operator==(const Atom&, const Atom&) = default;
};
using Product = std::vector<Atom>;

// The values of a variable in its unit; empty: the run lacks it.
using VariableValues =
    std::function<Eigen::RowVectorXd(const std::string& variable, const Trace& trace)>;
Eigen::RowVectorXd ValuesInUnit(const std::string& variable, const Trace& trace);

struct Expression {
  std::vector<Product> terms;

  Eigen::Index columns() const;
  // `values`: in place of those of the trace.
  Eigen::MatrixXd Of(const Trace& trace, const VariableValues& values = ValuesInUnit) const;
  std::string Text() const;
  // Each once.
  std::vector<std::string> Variables() const;
};

// One row, but for a B-spline.
Eigen::MatrixXd ValuesOfAtom(const Atom& atom, const Trace& trace,
                             const VariableValues& values = ValuesInUnit);
Eigen::Index ColumnsOfAtom(const Atom& atom);
std::string TextOf(const Atom& atom);
std::string TextOf(const Product& product);

Expression ParseExpression(const std::string& text);

}  // namespace abbe::simulation
