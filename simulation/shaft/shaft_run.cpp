#include "simulation/shaft/shaft_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "failure/failure.h"
#include "paths/shaft_readings.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Recording;

constexpr double kTurn = 2.0 * std::numbers::pi;

std::string AngleColumn(const Recording& recording) {
  for (const char* name : {"shaft_deg", "shaft_rad"}) {
    if (recording.Find(name)) return name;
  }
  throw InputError(fmt::format(
      "{}: has no column shaft_deg or shaft_rad; name the angle of the shaft so", recording.name));
}

// gap_1_mm, gap_2_mm, ...
std::vector<std::string> GapColumns(const Recording& recording) {
  std::vector<std::string> gaps;
  while (true) {
    const std::string begin = fmt::format("gap_{}_", gaps.size() + 1);
    const auto found =
        std::find_if(recording.columns.begin(), recording.columns.end(),
                     [&](const auto& column) { return column.name.starts_with(begin); });
    if (found == recording.columns.end()) break;
    gaps.push_back(found->name);
  }
  if (gaps.empty()) {
    throw InputError(fmt::format(
        "{}: has no column gap_1_mm; name the sensors gap_1_mm, gap_2_mm, ...", recording.name));
  }
  if (gaps.size() > kMostRimSensors) {
    throw InputError(fmt::format("{}: has {} gap sensors; leave all but {} out", recording.name,
                                 gaps.size(), kMostRimSensors));
  }
  return gaps;
}

std::vector<double> PlacesOf(const Recording& recording, std::size_t sensors) {
  auto degrees = recording.HeaderNumbers("sensor_deg", sensors);
  if (!degrees) {
    throw InputError(
        fmt::format("{}: the header does not say where the sensors stand round the shaft; add for "
                    "example sensor_deg = [0, 120, 240], in the order of the gap columns, or give "
                    "--sensor-deg to abbe convert",
                    recording.name));
  }
  for (double& place : *degrees) place *= std::numbers::pi / 180.0;
  return *degrees;
}

int StatedSense(const Recording& recording) {
  const auto sense = recording.HeaderNumber("shaft_sense");
  if (!sense) return 0;
  if (std::abs(*sense) == 1.0) return static_cast<int>(*sense);
  throw InputError(
      fmt::format("{}: shaft_sense = {} must be 1 (the shaft's angle grows as the "
                  "sensors are counted) or -1; without it, it is found",
                  recording.name, *sense));
}

double StatedNoise(const Recording& recording) {
  const auto stated = recording.HeaderNumber("u_gap_um");
  if (!stated) return 0.0;
  if (*stated > 0.0) return 1e-6 * *stated;
  throw InputError(fmt::format("{}: u_gap_um = {} must be above 0: it is the noise of the sensors",
                               recording.name, *stated));
}

// The mean of some readings.
struct Cell {
  double time = 0.0, shaft = 0.0, gap = 0.0;
};

// In time, not in angle: while the stamps of the angle are late, too few readings would stand for
// much of a turn.
std::vector<Cell> CellsOf(const paths::ShaftReadings& readings) {
  constexpr double kAside = 0.25;  // of a cell: readings at an even pace do not meet its ends
  const auto [least, most] = std::minmax_element(readings.angle.begin(), readings.angle.end());
  const double speed = (*most - *least) / (readings.time.back() - readings.time.front());
  std::vector<Cell> cells;
  for (std::size_t first = 0, last = 0; first < readings.time.size(); first = last) {
    const auto cell_of = [&](std::size_t i) {
      return std::floor((readings.time[i] - readings.time.front()) * speed / kCell + kAside);
    };
    Cell sum;
    for (; last < readings.time.size() && cell_of(last) == cell_of(first); ++last) {
      sum.time += readings.time[last];
      sum.shaft += readings.angle[last];
      sum.gap += readings.value[last];
    }
    const double count = last - first;
    cells.push_back({sum.time / count, sum.shaft / count, sum.gap / count});
  }
  return cells;
}

void RefuseLessThanATurn(const Recording& recording, const std::string& column,
                         const paths::ShaftReadings& readings) {
  const auto [least, most] = std::minmax_element(readings.angle.begin(), readings.angle.end());
  const double turns = (*most - *least) / kTurn;
  if (turns >= 1.0) return;
  throw InputError(fmt::format(
      "{}: the shaft turned by {:.2f} of a turn under {}; record a whole turn, better three",
      recording.name, turns, column));
}

ShaftRun Gathered(const ShaftRun& run, const std::vector<Index>& rows) {
  ShaftRun part = run;
  part.time = run.time(rows);
  part.rim.gap = run.rim.gap(rows);
  part.rim.shaft = run.rim.shaft(rows);
  part.rim.place = run.rim.place(rows);
  part.rim.seen = run.rim.seen(rows);
  part.rim.slope = run.rim.slope(rows);
  part.rim.by_angle = run.rim.by_angle(rows);
  part.rim.by_angle_twice = run.rim.by_angle_twice(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    part.rim.sensor[i] = run.rim.sensor[rows[i]];
    part.turn[i] = run.turn[rows[i]];
  }
  part.rim.sensor.resize(rows.size());
  part.turn.resize(rows.size());
  return part;
}

}  // namespace

ShaftRun ReadShaftRun(const Recording& recording) {
  const std::string angle = AngleColumn(recording);
  const std::vector<std::string> gaps = GapColumns(recording);
  const std::vector<double> places = PlacesOf(recording, gaps.size());
  ShaftRun run;
  run.name = recording.name;
  run.rim.sensors = static_cast<int>(gaps.size());
  run.sd.setConstant(run.rim.sensors, StatedNoise(recording));
  std::vector<Cell> cells;
  std::vector<double> place;
  for (std::size_t sensor = 0; sensor < gaps.size(); ++sensor) {
    const auto readings = paths::ReadShaft(recording, angle, gaps[sensor]);
    RefuseLessThanATurn(recording, gaps[sensor], readings);
    for (const Cell& cell : CellsOf(readings)) {
      cells.push_back(cell);
      place.push_back(places[sensor]);
      run.rim.sensor.push_back(static_cast<int>(sensor));
    }
  }
  const Index rows = cells.size();
  run.time.resize(rows);
  run.rim.gap.resize(rows);
  run.rim.shaft.resize(rows);
  for (Index row = 0; row < rows; ++row) {
    const Cell& cell = cells[row];
    run.time[row] = cell.time;
    run.rim.gap[row] = cell.gap;
    run.rim.shaft[row] = cell.shaft;
  }
  run.rim.place = Eigen::Map<const Eigen::RowVectorXd>(place.data(), rows);
  run.rim.slope.setOnes(rows);
  run.rim.seen.setZero(rows);
  run.rim.by_angle.setZero(rows);
  run.rim.by_angle_twice.setZero(rows);
  const double first = run.rim.shaft.minCoeff();
  for (const double shaft : run.rim.shaft) {
    run.turn.push_back(1 + static_cast<int>((shaft - first) / kTurn));
  }
  if (const int sense = StatedSense(recording); sense != 0) SetSense(sense, run);
  return run;
}

void SetSense(int sense, ShaftRun& run) {
  if (sense * (run.sense == 0 ? 1 : run.sense) < 0) run.rim.place *= -1.0;
  run.sense = sense;
}

ShaftRun Thinned(const ShaftRun& run, Index most) {
  if (run.rows() <= most) return run;
  const Index step = (run.rows() + most - 1) / most;
  std::vector<Index> kept;
  for (Index row = 0; row < run.rows(); row += step) kept.push_back(row);
  return Gathered(run, kept);
}

}  // namespace abbe::simulation
