#include "standards/diagonals.h"

#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::standards {

DiagonalFigures EvaluateDiagonal(const DiagonalRuns& runs) {
  if (runs.forward.size() < 2 ||
      (!runs.backward.empty() && runs.backward.size() != runs.forward.size())) {
    throw InputError("a diagonal needs at least two targets, the same in both directions");
  }
  std::vector<double> all = runs.forward;
  all.insert(all.end(), runs.backward.begin(), runs.backward.end());
  if (!std::all_of(all.begin(), all.end(), [](double d) { return std::isfinite(d); })) {
    throw InputError("a deviation of the diagonal is not a finite number");
  }
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  DiagonalFigures figures{*high - *low, 0.0};
  for (std::size_t i = 0; i < runs.backward.size(); ++i) {
    figures.B = std::max(figures.B, std::abs(runs.forward[i] - runs.backward[i]));
  }
  return figures;
}

DiagonalFigures EvaluateDiagonals(std::span<const DiagonalRuns> diagonals) {
  DiagonalFigures worst;
  for (const DiagonalRuns& runs : diagonals) {
    const DiagonalFigures figures = EvaluateDiagonal(runs);
    worst = {std::max(worst.E, figures.E), std::max(worst.B, figures.B)};
  }
  return worst;
}

}  // namespace abbe::standards
