// The seam behind which an error function over an axis may take any form: f(x; c), a number for a
// position x and n coefficients c.
//
// A form is immutable and holds no coefficients, so that several functions share it. To add one:
// derive, give it a maker in a file of its own (standard_forms.h, tanh_network.h), and a line in
// form_of_shape.cpp, so that files can hold it.
// Units: x in m, f in m or rad. Failure: none here; error_function.h guards the range of x.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace abbe::machine {

// The numbers that a form was made of, by name, with their unit in SI: {"degree": [3], "knots_m":
// [...]}.
using FormShape = std::map<std::string, std::vector<double>>;

class FunctionForm {
 public:
  virtual ~FunctionForm() = default;

  virtual std::string Name() const = 0;  // "b-spline"
  virtual int size() const = 0;          // n
  // With Name() all that FormOf (form_of_shape.h) needs to make the form anew.
  virtual FormShape Shape() const = 0;
  // A linear form is a sum of coefficients times functions of x: its gradient knows no c.
  virtual bool IsLinear() const = 0;

  // f(x; c). Where they are not null, *slope becomes df/dx and gradient[0 ... n-1] df/dc.
  virtual double Evaluate(double x, const double* c, double* slope, double* gradient) const = 0;

  // Places from a to b, both included, between which x f(x) is smooth enough for a Gauss-Legendre
  // rule of 16 points to integrate it to rounding.
  virtual std::vector<double> Pieces(double a, double b) const = 0;
};

}  // namespace abbe::machine
