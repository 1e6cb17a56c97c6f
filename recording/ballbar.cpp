#include "recording/ballbar.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::recording {
namespace {

using settings::kMicrometre;
using settings::kMillimetre;

std::span<const double> Wanted(const Recording& table, std::string_view name,
                               std::string_view meaning) {
  if (const auto column = table.Find(name)) return *column;
  throw InputError(fmt::format("{}: no column {}, {}; name it with --column {}=COLUMN", table.name,
                               name, meaning, name));
}

Column Filled(std::string name, std::size_t rows) {
  return {std::move(name), std::vector<double>(rows)};
}

// A new pass where the circle turns round: where the angle goes back by kTurnsRound.
Column PassesOf(std::span<const double> degrees) {
  constexpr double kTurnsRound = 2.0, kWhole = 360.0;
  Column pass = Filled("pass", degrees.size());
  double at = 0.0, extreme = 0.0, sense = 0.0;  // turned since the first row; the last extreme
  std::size_t last = 0;                         // its row
  int number = 1;
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    if (i > 0) {
      const double step = degrees[i] - degrees[i - 1];
      if (std::isfinite(step)) at += step - kWhole * std::round(step / kWhole);
    }
    const bool turns_round = sense != 0.0 && sense * (at - extreme) < -kTurnsRound;
    if (turns_round) {
      ++number;
      for (std::size_t k = last + 1; k < i; ++k) pass.values[k] = number;
    }
    if (turns_round || (sense == 0.0 && at != 0.0)) sense = at > extreme ? 1.0 : -1.0;
    if (sense * (at - extreme) >= 0.0) {
      extreme = at;
      last = i;
    }
    pass.values[i] = number;
  }
  return pass;
}

}  // namespace

Recording BallbarOf(const Recording& table, const BallbarCircle& circle) {
  const std::string& plane = circle.plane;
  if (plane != "XY" && plane != "YZ" && plane != "ZX") {
    throw InputError(fmt::format("{}: plane \"{}\": choose XY, YZ or ZX", table.name, plane));
  }
  if (!(circle.radius_mm > 0.0)) {
    throw InputError(fmt::format("{}: a ballbar of {} mm; give the programmed radius", table.name,
                                 circle.radius_mm));
  }
  const auto& centre = circle.centre_mm;
  if (!centre.empty() && centre.size() != 3) {
    throw InputError(fmt::format("{}: the centre has {} numbers; give three, X,Y,Z in mm",
                                 table.name, centre.size()));
  }
  const auto angles = Wanted(table, "angle_deg", "the commanded angle");
  const auto radii = table.Find("ref_radius_mm");
  const auto deviations =
      radii ? *radii : Wanted(table, "deviation_um", "the radius less the nominal one");
  const auto position = [&](int axis) {
    return Filled(fmt::format("{}_mm", static_cast<char>(plane[axis] - 'A' + 'a')), angles.size());
  };
  Column first = position(0), second = position(1), radius = Filled("ref_radius_mm", angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double angle = angles[i] * std::numbers::pi / 180.0;
    first.values[i] = circle.radius_mm * std::cos(angle);
    second.values[i] = circle.radius_mm * std::sin(angle);
    radius.values[i] =
        radii ? deviations[i] : circle.radius_mm + deviations[i] * (kMicrometre / kMillimetre);
  }
  Recording recording;
  recording.name = table.name;
  recording.warnings = table.warnings;
  recording.header =
      fmt::format("kind = \"ballbar\"\naxis = \"{}\"\nradius_mm = {}\n", plane, circle.radius_mm);
  if (table.HeaderText("time") == "order") recording.header += "time = \"order\"\n";
  if (!centre.empty()) {
    recording.header += fmt::format("centre_mm = [{}]\n", fmt::join(centre, ", "));
  }
  if (circle.u_length_um > 0.0) {
    recording.header += fmt::format("u_length_um = {}\n", circle.u_length_um);
  }
  if (!circle.ballbar.empty()) {
    recording.header += fmt::format("[mounting]\nballbar = {}\n", settings::Quoted(circle.ballbar));
  }
  const auto keep = [&](std::string_view name) {
    const auto column = table.Find(name);
    if (column) recording.columns.push_back({std::string(name), {column->begin(), column->end()}});
  };
  keep("time_s");
  recording.columns.push_back(std::move(first));
  recording.columns.push_back(std::move(second));
  recording.columns.push_back(PassesOf(angles));
  recording.columns.push_back(std::move(radius));
  if (circle.feed_mm_min > 0.0) {
    recording.columns.push_back(
        {"feed_mm_min", std::vector<double>(angles.size(), circle.feed_mm_min)});
  }
  for (const Column& column : table.columns) {
    if (column.name.starts_with("temp_")) keep(column.name);
  }
  keep("flags");
  return recording;
}

}  // namespace abbe::recording
