#include "settings/unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

namespace abbe::settings {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The first match counts, so longer endings come first.
constexpr std::array<std::pair<std::string_view, Unit>, 29> kEndings{{
    {"_ppm_per_c", {"ppm/degC", 1e-6}},
    {"_nm_per_mm2", {"nm/mm^2", 1e-3}},
    {"_urad_per_m", {"urad/m", 1e-6}},
    {"_urad_per_newton_m", {"urad/(N m)", 1e-6}},
    {"_um_per_c", {"um/degC", 1e-6}},
    {"_per_mm", {"1/mm", 1e3}},
    {"_mm_min", {"mm/min", 1e-3 / 60.0}},
    {"_m_min", {"m/min", 1.0 / 60.0}},
    {"_mm_s2", {"mm/s^2", 1e-3}},
    {"_mm_s", {"mm/s", 1e-3}},
    {"_rad_s", {"rad/s", 1.0}},
    {"_urad", {"urad", 1e-6}},
    {"_mrad", {"mrad", 1e-3}},
    {"_rad", {"rad", 1.0}},
    {"_deg", {"deg", kDegree}},
    {"_ppm", {"ppm", 1e-6}},
    {"_min", {"min", 60.0}},
    {"_mm", {"mm", 1e-3}},
    {"_um", {"um", 1e-6}},
    {"_nm", {"nm", 1e-9}},
    {"_inch", {"inch", 25.4e-3}},
    {"_ms", {"ms", 1e-3}},
    {"_us", {"us", 1e-6}},
    {"_hz", {"Hz", 1.0}},
    {"_m", {"m", 1.0}},
    {"_s", {"s", 1.0}},
    {"_c", {"degC", 1.0}},
    {"_v", {"V", 1.0}},
    {"_n", {"N", 1.0}},
}};

// Other spellings of their names.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kSpellings{{
    {"\u00b5m", "um"},
    {"\u03bcm", "um"},
    {"\u00b5rad", "urad"},
    {"\u03bcrad", "urad"},
    {"\u00b5s", "us"},
    {"\u03bcs", "us"},
    {"in", "inch"},
    {"\u00b0", "deg"},
    {"\u00b0C", "degC"},
    {"sec", "s"},
}};

// Units of one quantity each, between blanks.
constexpr std::array<std::string_view, 4> kQuantities{" m mm um nm inch ", " rad mrad urad deg ",
                                                      " s ms us min ", " mm/min m/min mm/s "};

const std::pair<std::string_view, Unit>* EndingOf(std::string_view name) {
  for (const auto& ending : kEndings) {
    if (name.ends_with(ending.first)) return &ending;
  }
  return nullptr;
}

}  // namespace

Unit UnitOf(std::string_view name) {
  const auto* const ending = EndingOf(name);
  return ending == nullptr ? Unit{"", 1.0} : ending->second;
}

Unit WrittenUnit(std::string_view text) {
  for (const auto& [spelling, name] : kSpellings) {
    if (spelling == text) text = name;
  }
  for (const auto& [ending, unit] : kEndings) {
    if (unit.name == text) return unit;
  }
  return {"", 1.0};
}

bool MeasureTheSame(const Unit& one, const Unit& other) {
  if (one.name == other.name) return true;
  const auto has = [](std::string_view quantity, const Unit& unit) {
    return quantity.find(fmt::format(" {} ", unit.name)) != std::string_view::npos;
  };
  return std::ranges::any_of(kQuantities, [&](std::string_view quantity) {
    return has(quantity, one) && has(quantity, other);
  });
}

std::string_view StemOf(std::string_view name) {
  const auto* const ending = EndingOf(name);
  if (ending != nullptr) name.remove_suffix(ending->first.size());
  return name;
}

}  // namespace abbe::settings
