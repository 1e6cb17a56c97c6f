#include "diagnosis/repeated_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/planned_paths.h"
#include "diagnosis/planned_run.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::diagnosis {
namespace {

using recording::Recording;

std::string MountingOf(const Recording& run) {
  if (run.Kind() == "linkage") return run.HeaderText("mounting.base").value_or("");
  if (auto id = run.HeaderText("mounting.id")) return *std::move(id);
  return run.HeaderText("mounting").value_or(run.name);  // as a sweep without one counts
}

}  // namespace

Recording Again(const Recording& run, const AgainAbout& about) {
  std::string more;
  if (const auto axis = run.HeaderText("axis")) more += fmt::format("axis = {}\n", Quoted(*axis));
  for (const char* key : {"sweep.window_um", "sweep.settle_s"}) {
    if (const auto value = run.HeaderNumber(key)) more += fmt::format("{} = {}\n", key, *value);
  }
  const std::string mounting = about.mounting.empty() ? MountingOf(run) : about.mounting;
  const bool of_base = run.Kind() == "linkage";
  std::string table = fmt::format("{} = {}\n", of_base ? "base" : "id", Quoted(mounting));
  if (!of_base) {
    const simulation::SweepMounting mounted =
        about.mounting.empty() ? simulation::MountedOf(run) : about.mounted;
    table += fmt::format("head = {}\ntarget_shift_mm = {}\ntarget_reversed = {}\n",
                         Quoted(mounted.head_turned ? "180deg" : "0deg"),
                         1e3 * mounted.target_shift, mounted.target_reversed);
  }
  Recording again = run;
  again.header = HeaderOf({run.Kind(), about.machine, about.started, more, table});
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
    if (way * kMillimetre > simulation::kStayWindow) ++moved;
  }
  return 2 * moved > run.rows();
}

}  // namespace abbe::diagnosis
