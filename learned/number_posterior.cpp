#include "learned/number_posterior.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace abbe::learned {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Form = Atom::Form;

constexpr int kLevels = 3, kOneSide = 8;

// A number as it is even in: 1/P, ln tau.
double Even(Form form, const NumberGrid& grid, double number) {
  if (form == Form::kSine) return 1.0 / number;
  return grid.in_logarithm ? std::log(number) : number;
}

double BackFrom(Form form, const NumberGrid& grid, double even) {
  if (form == Form::kSine) return 1.0 / even;
  return grid.in_logarithm ? std::exp(even) : even;
}

struct Point {
  double even;
  Rated rated;
};

}  // namespace

NumberPosterior PosteriorOf(const diagnosis::Fit& fit, const Proposal& proposal, std::size_t atom,
                            const NumberGrid& grid) {
  const Form form = proposal.atoms[atom].form;
  const auto count = static_cast<double>(grid.numbers.size());
  const double first = Even(form, grid, proposal.atoms[atom].numbers[0]);
  double step = grid.length / std::max(count - 1.0, 1.0);
  const auto at = [&](double even) {
    Proposal moved = proposal;
    moved.atoms[atom].numbers[0] = Rounded(BackFrom(form, grid, even));
    return moved;
  };
  std::vector<Point> points;
  double middle = first;
  for (int level = 0; level < kLevels; ++level, step /= kOneSide) {
    std::vector<Proposal> moved;
    std::vector<double> evens;
    for (int i = -kOneSide; i <= kOneSide; ++i) {
      const double even = middle + i * step / kOneSide;
      if (form == Form::kSine && !(even > 0.0)) continue;
      const bool is_place = form == Form::kStep || form == Form::kKink;
      if (is_place && (even < grid.numbers.front() || even > grid.numbers.back())) continue;
      moved.push_back(at(even));
      evens.push_back(even);
    }
    std::vector<Rated> rated = AskByRow(fit, moved);
    for (std::size_t i = 0; i < rated.size(); ++i) {
      points.push_back({evens[i], std::move(rated[i])});
    }
    const auto best = std::ranges::max_element(
        points, {}, [](const Point& point) { return point.rated.chi_square; });
    middle = best->even;
  }
  std::ranges::sort(points, {}, &Point::even);
  const auto best = std::ranges::max_element(
      points, {}, [](const Point& point) { return point.rated.chi_square; });
  NumberPosterior posterior{best->rated};
  // Trapezoids between the points.
  const auto size = static_cast<Index>(points.size());
  VectorXd weight(size), even(size);
  for (Index i = 0; i < size; ++i) {
    even[i] = points[i].even;
    const double from = points[std::max<Index>(i - 1, 0)].even,
                 to = points[std::min<Index>(i + 1, size - 1)].even;
    weight[i] =
        0.5 * (to - from) * std::exp(0.5 * (points[i].rated.chi_square - best->rated.chi_square));
  }
  const double width = weight.sum();
  if (!(width > 0.0)) return posterior;
  posterior.log_share = std::min(0.0, std::log(width / grid.length));
  weight /= width;
  const double mean = weight.dot(even);
  constexpr double kAsGood = 1.0;  // chi-square
  Rated at_mean = AskByRow(fit, {at(mean)}).front();
  if (at_mean.chi_square > best->rated.chi_square - kAsGood) posterior.best = std::move(at_mean);
  const double found = Even(form, grid, posterior.best.proposal.atoms[atom].numbers[0]);
  const double spread = std::sqrt(weight.dot((even.array() - found).square().matrix()));
  const double least = step / kOneSide;  // the resolution of the scan
  const double u = std::max(2.0 * spread, least);
  posterior.u95 =
      0.5 * std::abs(BackFrom(form, grid, found + u) -
                     BackFrom(form, grid,
                              std::max(found - u, form == Form::kSine ? 0.1 * found : found - u)));
  const Index columns = posterior.best.coefficients.size();
  posterior.by_number = MatrixXd::Zero(columns, columns);
  for (Index i = 0; i < size; ++i) {
    const VectorXd& c = points[i].rated.coefficients;
    if (c.size() != columns) continue;
    const VectorXd off = c - posterior.best.coefficients;
    posterior.by_number += weight[i] * off * off.transpose();
  }
  return posterior;
}

}  // namespace abbe::learned
