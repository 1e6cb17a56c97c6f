// Denavit-Hartenberg rows of an arm as its machine file states them, for tests.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>

namespace abbe {

struct ArmRow {
  double theta, d, a, alpha;  // deg, mm
  bool fixed = false;
};

// The keys of [linkage] that state them.
inline std::string RowsText(std::span<const ArmRow> rows) {
  std::string text = "form = \"denavit-hartenberg\"\njoint = [\n";
  for (const ArmRow& row : rows) {
    text += fmt::format("{{ theta_deg = {}, d_mm = {}, a_mm = {}, alpha_deg = {}, fixed = {} }},\n",
                        row.theta, row.d, row.a, row.alpha, row.fixed);
  }
  return text + "]\n";
}

}  // namespace abbe
