#include "history/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "failure/failure.h"
#include "history/shared_uncertainty.h"
#include "standards/student_coverage.h"

namespace abbe::history {
namespace {

using Key = std::tuple<std::string, std::string, std::string>;  // object, quantity, conditions

// The last of each name counts: a repetition replaces what it repeats.
std::map<Key, Figure> FiguresIn(const StoredCampaign& campaign) {
  std::map<Key, Figure> figures;
  for (const ResultFile& result : campaign.results) {
    for (const Figure& each : result.extract.figures) {
      figures[{each.object, each.quantity, each.conditions}] = each;
    }
  }
  return figures;
}

std::map<Key, Curve> CurvesIn(const StoredCampaign& campaign) {
  std::map<Key, Curve> curves;
  for (const ResultFile& result : campaign.results) {
    for (const Curve& each : result.extract.curves) {
      curves[{each.object, each.unit, each.conditions}] = each;
    }
  }
  return curves;
}

// Effective degrees of freedom of u and v together, from the coverage factor of each.
double DegreesOfFreedom(double u, double of_u, double v, double of_v, double together) {
  const double part = std::pow(u, 4) / standards::DegreesOfFreedomOf(of_u) +
                      std::pow(v, 4) / standards::DegreesOfFreedomOf(of_v);
  return part > 0.0 ? std::pow(together, 4) / part : std::numeric_limits<double>::infinity();
}

// 2 for normal uncertainties, as elsewhere.
double Coverage(double degrees_of_freedom) {
  return std::isfinite(degrees_of_freedom) ? standards::StudentCoverage(degrees_of_freedom)
                                           : standards::kCoverage;
}

double Probability(double change, double u, double degrees_of_freedom) {
  if (!(u > 0.0)) return change == 0.0 ? 1.0 : 0.0;
  return standards::StudentTwoSided(std::abs(change) / u, degrees_of_freedom);
}

std::vector<std::string> SharedOf(const Shares& shares, const Instruments& one,
                                  const Instruments& other) {
  std::vector<std::string> shared;
  for (const auto& [role, share] : shares) {
    if (share > 0.0 && IsShared(role, one, other)) shared.push_back(role);
  }
  return shared;
}

Difference OfFigures(const Figure& before, const Figure& after, const Instruments& one,
                     const Instruments& other) {
  Difference result;
  result.object = after.object;
  result.quantity = after.quantity;
  result.conditions = after.conditions;
  result.before = before.value;
  result.after = after.value;
  result.change = after.value - before.value;
  if (!before.u || !after.u) return result;
  const double u = OfDifference(*before.u, before.shares, *after.u, after.shares, one, other);
  const double dof = DegreesOfFreedom(*before.u, before.coverage, *after.u, after.coverage, u);
  result.U95 = Coverage(dof) * u;
  result.p = Probability(result.change, u, dof);
  result.shared = SharedOf(after.shares, one, other);
  return result;
}

// The value of a list over increasing positions, linear between two of them; NaN outside.
double At(const std::vector<double>& positions, const std::vector<double>& values, double x) {
  const auto above = std::ranges::lower_bound(positions, x);
  if (above == positions.end()) return std::numeric_limits<double>::quiet_NaN();
  const auto i = static_cast<std::size_t>(above - positions.begin());
  if (*above == x) return values[i];
  if (i == 0) return std::numeric_limits<double>::quiet_NaN();
  const double part = (x - positions[i - 1]) / (positions[i] - positions[i - 1]);
  return (1.0 - part) * values[i - 1] + part * values[i];
}

void AddPosition(double x, double change, double u, double dof, Difference& result) {
  result.positions_mm.push_back(x);
  result.changes.push_back(change);
  result.U95s.push_back(Coverage(dof) * u);
}

std::optional<Difference> OfCurves(const Curve& before, const Curve& after, const Instruments& one,
                                   const Instruments& other) {
  Difference result;
  result.object = after.object;
  result.quantity = "curve_" + after.unit;
  result.conditions = after.conditions;
  result.is_curve = true;
  const bool states_u =
      before.u.size() == before.value.size() && after.u.size() == after.value.size();
  double least = 2.0;
  for (std::size_t i = 0; i < after.value.size(); ++i) {
    const double x = after.positions_mm[i], was = At(before.positions_mm, before.value, x);
    const double change = after.value[i] - was;
    if (!std::isfinite(change)) continue;
    if (!states_u) {
      AddPosition(x, change, 0.0, std::numeric_limits<double>::infinity(), result);
      continue;
    }
    const double u_was = At(before.positions_mm, before.u, x);
    const double u = OfDifference(u_was, before.shares, after.u[i], after.shares, one, other);
    const double dof = DegreesOfFreedom(u_was, before.coverage, after.u[i], after.coverage, u);
    AddPosition(x, change, u, dof, result);
    const double p = Probability(change, u, dof);
    if (p >= least) continue;
    least = p;
    result.at_mm = x;
    result.before = was;
    result.after = after.value[i];
    result.change = change;
    result.U95 = result.U95s.back();
  }
  if (result.changes.empty()) return std::nullopt;
  if (!states_u) {
    const auto largest = std::ranges::max_element(result.changes, {},
                                                  [](double change) { return std::abs(change); });
    const auto i = static_cast<std::size_t>(largest - result.changes.begin());
    result.change = *largest;
    result.at_mm = result.positions_mm[i];
    result.after = At(after.positions_mm, after.value, result.at_mm);
    result.before = result.after - *largest;
    result.U95s.clear();
    return result;
  }
  result.p = std::min(1.0, least * static_cast<double>(result.changes.size()));
  result.shared = SharedOf(after.shares, one, other);
  return result;
}

// Holm: the i-th smallest of m probabilities against level / (m - i), until one is larger.
void MarkSignificant(std::vector<Difference>& differences, double level) {
  std::vector<Difference*> judged;
  for (Difference& each : differences) {
    if (each.p) judged.push_back(&each);
  }
  std::ranges::sort(judged, {}, [](const Difference* each) { return *each->p; });
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (*judged[i]->p > level / static_cast<double>(judged.size() - i)) break;
    judged[i]->significant = true;
  }
}

std::vector<Finding> FindingsIn(const StoredCampaign& campaign) {
  std::vector<Finding> findings;
  for (const ResultFile& result : campaign.results) {
    const auto& of = result.extract.findings;
    findings.insert(findings.end(), of.begin(), of.end());
  }
  return findings;
}

std::vector<Finding> Without(const std::vector<Finding>& findings,
                             const std::vector<Finding>& others) {
  std::vector<Finding> left;
  for (const Finding& each : findings) {
    const bool there = std::ranges::any_of(others, [&](const Finding& other) {
      return other.cause == each.cause && other.object == each.object;
    });
    if (!there) left.push_back(each);
  }
  return left;
}

template <typename One>
void NamesOnlyIn(const std::map<Key, One>& one, const std::map<Key, One>& other,
                 std::vector<std::string>& names) {
  for (const auto& [key, value] : one) {
    if (other.contains(key)) continue;
    const auto& [object, quantity, conditions] = key;
    std::string name = object.empty() ? quantity : object + "." + quantity;
    if (!conditions.empty()) name += " (" + conditions + ")";
    names.push_back(std::move(name));
  }
}

}  // namespace

Comparison Compare(const StoredCampaign& before, const StoredCampaign& after, double level) {
  if (before.head.machine != after.head.machine) {
    throw InputError(
        fmt::format("campaign {} is of \"{}\", campaign {} of \"{}\"; compare two of one machine",
                    before.head.id, before.head.machine, after.head.id, after.head.machine));
  }
  Comparison comparison{before.head, after.head, level, {}, {}, {}, {}, {}};
  const auto figures = FiguresIn(before), later = FiguresIn(after);
  for (const auto& [key, figure] : later) {
    const auto earlier = figures.find(key);
    if (earlier == figures.end()) continue;
    comparison.differences.push_back(
        OfFigures(earlier->second, figure, before.instruments, after.instruments));
  }
  const auto curves = CurvesIn(before), later_curves = CurvesIn(after);
  for (const auto& [key, curve] : later_curves) {
    const auto earlier = curves.find(key);
    if (earlier == curves.end()) continue;
    auto difference = OfCurves(earlier->second, curve, before.instruments, after.instruments);
    if (difference) comparison.differences.push_back(std::move(*difference));
  }
  if (comparison.differences.empty()) {
    throw InputError(fmt::format(
        "campaigns {} and {} have no figure in common: their tests or their conditions differ; "
        "abbe history show lists the figures of each",
        before.head.id, after.head.id));
  }
  MarkSignificant(comparison.differences, level);
  std::ranges::stable_sort(comparison.differences, {}, [](const Difference& each) {
    return std::tuple(!each.significant, each.Name(), each.conditions);
  });
  NamesOnlyIn(figures, later, comparison.only_before);
  NamesOnlyIn(later, figures, comparison.only_after);
  comparison.new_findings = Without(FindingsIn(after), FindingsIn(before));
  comparison.gone_findings = Without(FindingsIn(before), FindingsIn(after));
  return comparison;
}

}  // namespace abbe::history
