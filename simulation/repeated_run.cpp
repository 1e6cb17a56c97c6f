#include "simulation/repeated_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "settings/toml_text.h"
#include "simulation/planned_paths.h"
#include "simulation/planned_run.h"

namespace abbe::simulation {

using recording::Recording;

Recording Again(const Recording& run, const AgainAbout& about) {
  std::string more;
  if (const auto axis = run.HeaderText("axis")) {
    more += fmt::format("axis = {}\n", settings::Quoted(*axis));
  }
  for (const char* key : {"sweep.window_um", "sweep.settle_s"}) {
    if (const auto value = run.HeaderNumber(key)) more += fmt::format("{} = {}\n", key, *value);
  }
  Recording again = run;
  again.header = HeaderOf({run.Kind(), about.machine, about.started, more, about.mounting});
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

std::string ShortName(const Recording& run) {
  return std::filesystem::path(run.name).stem().string();
}

}  // namespace abbe::simulation
