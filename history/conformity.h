// Figures against limits, with the decision rule of ISO 14253-1.
//
//   for (const Judged& each : Judge(figures, limits)) {
//     if (each.verdict == Verdict::kFail) fmt::print("{} {}\n", each.limit.Name(), each.value);
//   }
//
// Rule, with the amount |y| of a figure, its expanded uncertainty U95 = k u of two sides and the
// limit L:
//
//   pass       |y| + U95 <= L
//   fail       |y| - U95 >  L
//   undecided  between the two: neither is proven
//
// A figure without an uncertainty is undecided: nothing is proven by it. So is one within its limit
// whose sweep lacks stations that were planned, or leaves more than a tenth of the travel out: what
// was not measured may be worse. A limit that no figure belongs to is not measured.
//
// Units: those of the figures. Source: ISO 14253-1:2017 with the guard band g = U95; not checked
// against its text. That edition asks for a conformance probability of 95 % of one side, a guard
// band of 1.65 u; U95 = 2 u is stricter and gives 97.7 %.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "history/figure.h"
#include "history/limits.h"

namespace abbe::history {

enum class Verdict { kPass, kFail, kUndecided, kNotMeasured };

std::string_view Name(Verdict verdict);  // "pass", "fail", "undecided", "not measured"

struct Judged {
  Limit limit;
  Verdict verdict = Verdict::kNotMeasured;
  std::string object, conditions;  // of the figure
  double value = 0.0;
  std::optional<double> U95{};
  bool u_from_limit = false;  // U95 is that of the machine file
  std::string reason{};       // why a figure that is no fail is no pass either, if not its U95
};

// One entry for each limit and each figure that it is for, in the order of the limits. A limit of
// an object replaces that of its quantity for all objects.
std::vector<Judged> Judge(const std::vector<Figure>& figures, const Limits& limits,
                          const Travels& travels = {});

// The limit for a figure, or null.
const Limit* LimitOf(const std::string& object, const std::string& quantity, const Limits& limits);

}  // namespace abbe::history
