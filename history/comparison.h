// What changed between two campaigns: differences of figures and curves with their uncertainty, and
// which of them are significant.
//
//   const Comparison comparison = Compare(store.Read(3), store.Read(7));
//   for (const Difference& each : comparison.differences) {
//     if (each.significant) fmt::print("{} {} +- {}\n", each.Name(), each.change, *each.U95);
//   }
//
// Uncertainty: history/shared_uncertainty.h; parts of the same head in the same mounting, of the
// same linkage or calibrated length cancel. Degrees of freedom by Welch and Satterthwaite from the
// coverage factors.
//
// Significance: two-sided p by Student's t; of a curve the smallest over its n positions, times n
// (Bonferroni). Family-wise over all figures and curves by Holm's procedure at `level`, valid for
// any dependence among them: the chance of any false alarm is at most `level`.
//
// Units: those of figures and curves. Shapes: of a curve one change and one U95 a position; no U95
// where a result states no uncertainty. Failure: InputError when the campaigns are of two machines,
// or have no figure in common. Source: GUM (JCGM 100:2008), 5.2 and G.4; S. Holm, Scand. J. Stat.
// 6 (1979) 65-70.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "history/store.h"

namespace abbe::history {

struct Difference {
  std::string object, quantity, conditions;
  bool is_curve = false;
  double before = 0.0, after = 0.0, change = 0.0;  // of a curve: where it differs most for its u
  std::optional<double> U95;                       // of the change
  std::optional<double> p;
  bool significant = false;
  std::vector<std::string> shared;  // instruments whose part cancels
  // For a curve: the positions of the later one within the earlier one's.
  std::vector<double> positions_mm, changes, U95s;
  double at_mm = 0.0;

  std::string Name() const { return object.empty() ? quantity : object + "." + quantity; }
};

struct Comparison {
  CampaignHead before, after;
  double level = 0.0;
  std::vector<Difference> differences;  // significant ones first, then by name
  std::vector<std::string> only_before, only_after;
  std::vector<Finding> new_findings, gone_findings;  // causes of diagnoses
};

inline constexpr double kFamilyLevel = 0.05;

Comparison Compare(const StoredCampaign& before, const StoredCampaign& after,
                   double level = kFamilyLevel);

}  // namespace abbe::history
