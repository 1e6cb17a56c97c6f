// The residual of a fit: predicted minus measured values, as a function of the parameters.
//
// The input is one vector x of the parameters the residual depends on, in the order in which they
// were given when it was added to the problem; the output is `Rows()` numbers in SI units and their
// derivatives. It is not whitened: the problem divides it by the standard deviation stated with it.
//
//   class LineResidual : public Residual {           // x = [offset slope]
//    public:
//     LineResidual(Eigen::VectorXd at, Eigen::VectorXd y) : at_(at), y_(y) {}
//     Eigen::Index Rows() const override { return y_.size(); }
//     void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
//                   RowMatrix* jacobian) const override {
//       values = x[0] + x[1] * at_.array() - y_.array();
//       if (jacobian) *jacobian << Eigen::VectorXd::Ones(Rows()), at_;
//     }
//    private:
//     Eigen::VectorXd at_, y_;
//   };
//
// Many rows in one residual are cheap, many residuals of one row are not: put the readings of a run
// that depend on the same parameters into one. It keeps no Jacobian, so a million rows cost no
// memory. For derivatives without algebra see autodiff_residual.h.
// Threads: Evaluate is called from several at once.
// Units: SI. Shapes: values n x 1 and jacobian n x x.size() arrive with their size set; every
// element must be written.
// Failure: Evaluate throws NumericalError where the parameters are outside the model's domain (out
// of reach, singular): at the start Solve reports it with the source's name, later the step is
// rejected. Values that are not finite are treated the same way.
// Validity: derivatives must be those of the values: tests compare them with differences.
#pragma once

#include <Eigen/Core>
#include <utility>

namespace abbe::estimation {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Residual {
 public:
  virtual ~Residual() = default;
  virtual Eigen::Index Rows() const = 0;
  virtual void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                        RowMatrix* jacobian) const = 0;
  // The Jacobian is the same everywhere: the normal equations are solved once, without a search.
  virtual bool IsLinear() const { return false; }
};

// A x - b: a model that is linear, or a prior that ties several parameters together (smoothness).
class LinearResidual : public Residual {
 public:
  LinearResidual(RowMatrix a, Eigen::VectorXd b) : a_(std::move(a)), b_(std::move(b)) {}

  Eigen::Index Rows() const override { return b_.size(); }

  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                RowMatrix* jacobian) const override {
    values.noalias() = a_ * x;
    values -= b_;
    if (jacobian != nullptr) *jacobian = a_;
  }
  bool IsLinear() const override { return true; }

 private:
  RowMatrix a_;
  Eigen::VectorXd b_;
};

}  // namespace abbe::estimation
