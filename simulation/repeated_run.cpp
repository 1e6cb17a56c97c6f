#include "simulation/repeated_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "settings/toml_text.h"
#include "simulation/kinds.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/planned_run.h"

namespace abbe::simulation {

using recording::Recording;

std::string MountingIdOf(const Recording& run) {
  if (auto id = run.HeaderText("mounting.id")) return *std::move(id);
  return run.HeaderText("mounting").value_or(run.name);
}

Recording Again(const Recording& run, const AgainAbout& about) {
  std::string more;
  if (const auto axis = run.HeaderText("axis")) {
    more += fmt::format("axis = {}\n", settings::Quoted(*axis));
  }
  for (const char* key : {"sweep.window_um", "sweep.settle_s"}) {
    if (const auto value = run.HeaderNumber(key)) more += fmt::format("{} = {}\n", key, *value);
  }
  Recording again = run;
  again.header =
      HeaderOf({run.Kind(), about.machine, about.started, more,
                about.mounting.empty() ? KindOf(run).MountingTable(run) : about.mounting});
  return again;
}

Recording TurnedRound(Recording run) {
  for (auto& column : run.columns) std::reverse(column.values.begin(), column.values.end());
  auto& time = ColumnIn(run, "time_s");
  const double last = time.front();
  for (double& each : time) each = last - each;
  for (double& each : ColumnIn(run, "direction")) each = -each;
  auto& pass = ColumnIn(run, "pass");
  const auto [least, most] = std::minmax_element(pass.begin(), pass.end());
  const double sum = *least + *most;
  for (double& each : pass) each = sum - each;
  return run;
}

Recording AtFeed(Recording run, double times) {
  for (double& each : ColumnIn(run, "time_s")) each /= times;
  for (double& each : ColumnIn(run, "feed_mm_min")) each *= times;
  return run;
}

Recording Warmer(Recording run, double kelvin) {
  for (auto& column : run.columns) {
    if (!column.name.starts_with("temp_")) continue;
    for (double& each : column.values) each += kelvin;
  }
  return run;
}

Recording AnHourLater(const Recording& run, AgainAbout about) {
  constexpr double kHour = 3600.0;  // s
  about.started += kHour;
  return Warmer(Again(run, about), kWarmer);
}

bool Moves(const Recording& run) {
  constexpr double kMillimetre = 1e-3;
  std::size_t moved = 0;
  for (std::size_t row = 1; row < run.rows(); ++row) {
    double way = 0.0;
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      if (const auto column = run.Find(axis)) {
        way = std::max(way, std::abs((*column)[row] - (*column)[row - 1]));
      }
    }
    if (way * kMillimetre > kStayWindow) ++moved;
  }
  return 2 * moved > run.rows();
}

std::string ShortName(const Recording& run) {
  return std::filesystem::path(run.name).stem().string();
}

}  // namespace abbe::simulation
