// The interface of the forms of an error function: f(x; c), a function of the position x and n
// coefficients c.
//
// A form is immutable and holds no coefficients, so several functions can share it. To add one,
// derive a class, declare its maker in a header of its own (standard_forms.h, tanh_network.h) and
// add a line to form_of_shape.cpp, so that files can contain it.
// Units: x in m, f in m or rad. Shapes: c and gradient n x 1.
// Failure: none here; error_function.h checks the range of x.
// Source: of each form in the header of its maker.
// Validity: f has a derivative almost everywhere; at a knot of a table it is that of the piece to
// the right.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace abbe::machine {

// The numbers that define a form, by name, with the SI unit in the name:
// {"degree": [3], "knots_m": [...]}.
using FormShape = std::map<std::string, std::vector<double>>;

class FunctionForm {
 public:
  virtual ~FunctionForm() = default;

  virtual std::string Name() const = 0;  // "b-spline"
  virtual int size() const = 0;          // n
  // Name() and Shape() are the input of FormOf (form_of_shape.h), which makes the same form.
  virtual FormShape Shape() const = 0;
  // A linear form is a sum of coefficients times functions of x: its gradient does not depend on c.
  virtual bool IsLinear() const = 0;

  // f(x; c). Unless null, *slope becomes df/dx and gradient[0 ... n-1] df/dc.
  virtual double Evaluate(double x, const double* c, double* slope, double* gradient) const = 0;

  // Places from a to b, both included, between which x f(x) is smooth enough for a Gauss-Legendre
  // rule of 16 points to integrate it to rounding.
  virtual std::vector<double> Pieces(double a, double b) const = 0;
};

}  // namespace abbe::machine
