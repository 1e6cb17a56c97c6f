#include "simulation/stays.h"

#include <algorithm>
#include <cmath>

#include "recording/good_rows.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Recording;

constexpr double kTrembles = 5e-6;          // m
constexpr double kPauseBetweenStays = 0.5;  // s: rows farther apart belong to two stays

// Rows whose axes stand where they stood in the row before.
std::vector<bool> Stands(const Recording& recording, const std::vector<std::size_t>& rows) {
  std::vector<bool> stands(rows.size(), false);
  bool knows_axes = false;
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    if (!recording.Find(axis)) continue;
    if (!knows_axes) stands.assign(rows.size(), true);
    knows_axes = true;
    const auto place = recording::ValuesOf(recording, axis, rows);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      stands[i] = stands[i] && std::abs(place[i] - place[i - 1]) < kTrembles;
    }
  }
  if (recording.Find("time_s")) {
    const auto time = recording::ValuesOf(recording, "time_s", rows);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      stands[i] = stands[i] && time[i] - time[i - 1] < kPauseBetweenStays;
    }
  }
  stands.front() = false;
  return stands;
}

void KeepSeveral(Stays& stays) {
  std::erase_if(stays, [](const auto& stay) { return stay.size() < 2; });
}

}  // namespace

Stays StaysOf(const Recording& recording) {
  Stays stays;
  if (!recording::HasGoodRow(recording)) return stays;
  const auto rows = recording::GoodRows(recording);
  const auto stands = Stands(recording, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!stands[i]) stays.emplace_back();
    stays.back().push_back(rows[i]);
  }
  KeepSeveral(stays);
  return stays;
}

Stays SettledStays(const Recording& recording, double settle) {
  Stays stays = StaysOf(recording);
  const auto pass = recording.Find("pass"), time = recording.Find("time_s");
  for (auto& stay : stays) {
    if (pass && (*pass)[stay.front()] == 0.0) stay.clear();
    if (stay.empty() || !time) continue;
    const double from = (*time)[stay.front()] + settle;
    std::erase_if(stay, [&](std::size_t row) { return (*time)[row] < from; });
  }
  KeepSeveral(stays);
  return stays;
}

std::vector<estimation::Stay> ReadingsIn(const Recording& recording, const std::string& column,
                                         const Stays& stays) {
  std::vector<estimation::Stay> readings;
  const bool timed = recording.Find("time_s").has_value();
  for (const auto& rows : stays) {
    const auto value = recording::ValuesOf(recording, column, rows);
    const auto time =
        timed ? recording::ValuesOf(recording, "time_s", rows) : std::vector<double>{};
    const Index count = rows.size();
    estimation::Stay stay{Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (Index i = 0; i < count; ++i) {
      stay.time[i] = timed ? time[i] : rows[i];
      stay.value[i] = value[i];
    }
    readings.push_back(std::move(stay));
  }
  return readings;
}

}  // namespace abbe::simulation
