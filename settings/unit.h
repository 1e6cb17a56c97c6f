// Units of numbers at the edges. A key or a column carries its unit as the end of its name
// (`range_um`, `feed_mm_min`); inside abbe every number is SI. This is the one place that converts.
#pragma once

#include <string_view>

namespace abbe::settings {

inline constexpr double kMillimetre = 1e-3;
inline constexpr double kMicrometre = 1e-6;
inline constexpr double kNanometre = 1e-9;
inline constexpr double kMicroradian = 1e-6;
inline constexpr double kMillimetrePerMinute = kMillimetre / 60.0;
inline constexpr double kMicro = 1e-6;  // um or urad: for a table with both

constexpr double Mm(double metres) { return metres / kMillimetre; }
constexpr double Um(double metres) { return metres / kMicrometre; }

struct Unit {
  std::string_view name;  // as printed: "um", "mm/min"; empty for a plain number
  double si;              // value in SI = value in this unit * si (temperatures stay in degC)
};

// The unit in the ending of `name`: "probe_a_um" -> {"um", 1e-6}; a name without a known ending is
// a plain number. The longest ending wins ("feed_mm_min" is mm/min, not minutes).
Unit UnitOf(std::string_view name);

// The unit as tables write it: "mm", "\u00b5m", "inch", "mm/min", "\u00b0C"; none that is known is a
// plain number.
Unit WrittenUnit(std::string_view text);

// Whether a number in the one can be converted to the other: both are lengths, angles, times or
// feeds, or the same.
bool MeasureTheSame(const Unit& one, const Unit& other);

// `name` without that ending: "time_constant_s" -> "time_constant"; a plain number keeps its name.
std::string_view StemOf(std::string_view name);

}  // namespace abbe::settings
