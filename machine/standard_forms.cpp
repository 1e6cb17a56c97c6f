#include "machine/standard_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "failure/failure.h"

namespace abbe::machine {
namespace {

// Most waves of the highest harmonic of a Fourier series over a travel: 0.1 mm each over a metre.
constexpr int kMostWaves = 10000;

class BSplineForm : public FunctionForm {
 public:
  BSplineForm(std::string name, geometry::BSplineBasis basis)
      : name_(std::move(name)), basis_(std::move(basis)) {}

  std::string Name() const override { return name_; }
  int size() const override { return basis_.size(); }
  FormShape Shape() const override {
    const std::vector<double>& knots = basis_.knots();
    if (name_ == "table") return {{"positions_m", {knots.begin() + 1, knots.end() - 1}}};
    return {{"degree", {static_cast<double>(basis_.degree())}}, {"knots_m", knots}};
  }
  bool IsLinear() const override { return true; }

  double Evaluate(double x, const double* c, double* slope, double* gradient) const override {
    const auto local = basis_.At(x);
    const auto near = [&](const auto& values) {
      return values.dot(Eigen::Map<const Eigen::VectorXd>(c + local.first, values.size()));
    };
    if (slope != nullptr) *slope = near(basis_.At(x, 1).values);
    if (gradient != nullptr) {
      std::fill_n(gradient, size(), 0.0);
      std::copy(local.values.begin(), local.values.end(), gradient + local.first);
    }
    return near(local.values);
  }

  std::vector<double> Pieces(double a, double b) const override {
    std::vector<double> pieces = {a};
    for (const double knot : basis_.knots()) {
      if (knot > pieces.back() && knot < b) pieces.push_back(knot);
    }
    pieces.push_back(b);
    return pieces;
  }

 private:
  std::string name_;
  geometry::BSplineBasis basis_;
};

class PolynomialForm : public FunctionForm {
 public:
  PolynomialForm(int degree, double a, double b)
      : degree_(degree), a_(a), b_(b), middle_((a + b) / 2), half_((b - a) / 2) {}

  std::string Name() const override { return "polynomial"; }
  int size() const override { return degree_ + 1; }
  FormShape Shape() const override {
    return {{"degree", {static_cast<double>(degree_)}}, {"interval_m", {a_, b_}}};
  }
  bool IsLinear() const override { return true; }

  // T_(k+1) = 2 u T_k - T_(k-1), and its derivative.
  double Evaluate(double x, const double* c, double* slope, double* gradient) const override {
    const double u = (x - middle_) / half_;
    double t = 1.0, t_before = u, d = 0.0, d_before = 1.0;  // T_0, T_-1 = T_1 and derivatives
    double value = 0.0, rise = 0.0;
    for (int k = 0; k <= degree_; ++k) {
      if (gradient != nullptr) gradient[k] = t;
      value += c[k] * t;
      rise += c[k] * d;
      const double d_next = 2.0 * t + 2.0 * u * d - d_before;
      const double t_next = 2.0 * u * t - t_before;
      d_before = std::exchange(d, d_next);
      t_before = std::exchange(t, t_next);
    }
    if (slope != nullptr) *slope = rise / half_;
    return value;
  }

  std::vector<double> Pieces(double a, double b) const override { return {a, b}; }

 private:
  int degree_;
  double a_, b_, middle_, half_;
};

class FourierForm : public FunctionForm {
 public:
  FourierForm(int harmonics, double period) : harmonics_(harmonics), period_(period) {}

  std::string Name() const override { return "fourier"; }
  int size() const override { return 2 * harmonics_; }
  FormShape Shape() const override {
    return {{"harmonics", {static_cast<double>(harmonics_)}}, {"period_m", {period_}}};
  }
  bool IsLinear() const override { return true; }

  double Evaluate(double x, const double* c, double* slope, double* gradient) const override {
    const double w = 2.0 * std::numbers::pi / period_;
    double value = 0.0, rise = 0.0;
    for (int k = 1; k <= harmonics_; ++k) {
      const double sine = std::sin(k * w * x), cosine = std::cos(k * w * x);
      const double of_sine = c[2 * k - 2], of_cosine = c[2 * k - 1];
      value += of_sine * sine + of_cosine * cosine;
      rise += k * w * (of_sine * cosine - of_cosine * sine);
      if (gradient == nullptr) continue;
      gradient[2 * k - 2] = sine;
      gradient[2 * k - 1] = cosine;
    }
    if (slope != nullptr) *slope = rise;
    return value;
  }

  // One piece for each wave of the highest harmonic.
  std::vector<double> Pieces(double a, double b) const override {
    const double whole = (b - a) * harmonics_ / period_;
    if (!(whole <= kMostWaves)) {
      throw InputError(
          fmt::format("a Fourier series with {:.3g} waves over the travel: give {} or "
                      "fewer, by fewer harmonics or a longer period",
                      whole, kMostWaves));
    }
    const int waves = 1 + static_cast<int>(whole);
    std::vector<double> pieces;
    for (int i = 0; i <= waves; ++i) pieces.push_back(a + (b - a) * i / waves);
    return pieces;
  }

 private:
  int harmonics_;
  double period_;
};

}  // namespace

SharedForm MakeBSplineForm(geometry::BSplineBasis basis) {
  return std::make_shared<BSplineForm>("b-spline", std::move(basis));
}

SharedForm MakeTableForm(const std::vector<double>& positions) {
  if (positions.size() < 2) {
    throw InputError(fmt::format("a table with {} positions: give two or more", positions.size()));
  }
  for (std::size_t i = 1; i < positions.size(); ++i) {
    if (!(positions[i] > positions[i - 1])) {
      throw InputError(fmt::format("table position {} ({} m) is not above the one before it", i + 1,
                                   positions[i]));
    }
  }
  std::vector<double> knots = {positions.front()};
  knots.insert(knots.end(), positions.begin(), positions.end());
  knots.push_back(positions.back());
  return std::make_shared<BSplineForm>("table", geometry::BSplineBasis(1, std::move(knots)));
}

SharedForm MakePolynomialForm(int degree, double a, double b) {
  if (degree < 0 || degree > kMaxPolynomialDegree) {
    throw InputError(
        fmt::format("a polynomial of degree {}: give 0 to {}", degree, kMaxPolynomialDegree));
  }
  if (!(a < b)) throw InputError(fmt::format("a polynomial on the empty interval {} to {}", a, b));
  return std::make_shared<PolynomialForm>(degree, a, b);
}

SharedForm MakeFourierForm(int harmonics, double period) {
  if (harmonics < 1) {
    throw InputError(fmt::format("a Fourier series of {} harmonics: give 1 or more", harmonics));
  }
  if (!(period > 0.0)) {
    throw InputError(
        fmt::format("a Fourier series with the period {} m: give more than 0", period));
  }
  return std::make_shared<FourierForm>(harmonics, period);
}

}  // namespace abbe::machine
