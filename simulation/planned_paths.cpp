#include "simulation/planned_paths.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "recording/instant.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::simulation {
namespace {

using Eigen::Vector3d;
using recording::Recording;

struct Row {
  double time;
  Vector3d axes;
  int pass, direction;
  double feed = 0.0;
};

class PathMaker {
 public:
  PathMaker(const HeaderAbout& header, const PathAbout& about) : about_(about) {
    path_.header = HeaderOf(header);
    path_.name = "planned " + header.kind;
    for (const char* name :
         {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min"}) {
      path_.columns.push_back({name, {}});
    }
    for (const auto& [sensor, temperature] : about.temperature) {
      path_.columns.push_back({sensor, {}});
    }
  }

  void Add(const Row& row) {
    std::size_t column = 0;
    const auto put = [&](double value) { path_.columns[column++].values.push_back(value); };
    put(row.time);
    for (const double each : row.axes) put(each / settings::kMillimetre);
    put(row.pass);
    put(row.direction);
    put(row.feed / settings::kMillimetrePerMinute);
    for (const auto& [sensor, temperature] : about_.temperature) put(temperature);
  }

  Recording Take() { return std::move(path_); }

 private:
  const PathAbout& about_;
  Recording path_;
};

}  // namespace

std::string HeaderOf(const HeaderAbout& about) {
  return fmt::format("kind = \"{}\"\nmachine = {}\nstarted = {}\n{}[mounting]\n{}", about.kind,
                     settings::Quoted(about.machine),
                     settings::Quoted(recording::InstantText(about.started)), about.more,
                     about.mounting);
}

Recording CirclePath(const CirclePlan& plan, const PathAbout& about) {
  constexpr double kTurning = 5.0;  // s, before it goes round the other way
  const int first = plan.plane[0] - 'X', second = plan.plane[1] - 'X';
  PathMaker maker({plan.kind, about.machine, about.started, plan.more, plan.mounting}, about);
  const double turn = 2.0 * std::numbers::pi * plan.radius / plan.feed;
  double begin = 0.0;
  for (const int sense : {1, -1}) {
    for (int row = 0; row < plan.rows; ++row) {
      const double share = static_cast<double>(row) / plan.rows;
      const double angle = sense * 2.0 * std::numbers::pi * share;
      Vector3d axes = plan.centre;
      axes[first] += plan.radius * std::cos(angle);
      axes[second] += plan.radius * std::sin(angle);
      maker.Add({begin + share * turn, axes, sense > 0 ? 1 : 2, sense, plan.feed});
    }
    begin += turn + kTurning;
  }
  return maker.Take();
}

Recording GapStepPath(char axis, const Vector3d& start, const std::vector<double>& stations,
                      const PathAbout& about) {
  constexpr double kStep = 45e-6;              // m
  constexpr double kStand = 0.5, kMove = 1.0;  // s
  constexpr int kReadings = 20;                // in a stand
  PathMaker maker({"gap-steps", about.machine, about.started, fmt::format("axis = \"{}\"\n", axis)},
                  about);
  const int swept = axis - 'X';
  double begin = 0.0;
  for (std::size_t station = 0; station < stations.size(); ++station) {
    Vector3d place = start;
    place[swept] = stations[station];
    for (const int other : {(swept + 1) % 3, (swept + 2) % 3}) {
      int before = -1;
      for (const int step : {0, 1, 0, -1, 0}) {
        Vector3d axes = place;
        axes[other] += step * kStep;
        for (int reading = 0; reading < kReadings; ++reading) {
          maker.Add({begin + kStand * reading / kReadings, axes, static_cast<int>(station) + 1,
                     step > before ? 1 : -1});
        }
        before = step;
        begin += kStand + kMove;
      }
    }
  }
  return maker.Take();
}

Recording SweepPath(char axis, const std::array<machine::Travel, 3>& travels,
                    const std::string& mounting, const PathAbout& about) {
  constexpr int kSteps = 15;                                         // as a campaign, reduced
  constexpr double kStand = 0.6, kInterval = 0.047, kTurning = 1.0;  // s
  constexpr double kFeed = 600.0 * settings::kMillimetrePerMinute;
  PathMaker maker(
      {"sweep", about.machine, about.started, fmt::format("axis = \"{}\"\n", axis), mounting},
      about);
  const machine::Travel& travel = travels[axis - 'X'];
  const double step = (travel.last - travel.first) / kSteps;
  double begin = 0.0;
  for (const int direction : {1, -1}) {
    for (int i = 0; i <= kSteps; ++i) {
      Vector3d axes(travels[0].first, travels[1].first, travels[2].first);
      axes[axis - 'X'] = travel.first + (direction > 0 ? i : kSteps - i) * step;
      for (double since = 0.0; since < kStand; since += kInterval) {
        maker.Add({begin + since, axes, 1, direction, kFeed});
      }
      begin += kStand + step / kFeed;
    }
    begin += kTurning;
  }
  return maker.Take();
}

Recording GridPath(const GridPlan& plan, const PathAbout& about) {
  constexpr double kStand = 0.5;  // s
  constexpr int kReadings = 5;    // in a stand
  PathMaker maker({"linkage", about.machine, about.started, {}, plan.mounting}, about);
  Vector3d before = plan.middle - plan.size / 2;
  double begin = 0.0;
  const int lines = plan.counts[1] * plan.counts[2];
  for (int line = 0; line < lines; ++line) {
    const int z = line / plan.counts[1], y = line % plan.counts[1];
    for (int i = 0; i < plan.counts[0]; ++i) {
      const Eigen::Vector3i at(line % 2 == 0 ? i : plan.counts[0] - 1 - i,
                               z % 2 == 0 ? y : plan.counts[1] - 1 - y, z);
      const Vector3d share =
          at.cast<double>().cwiseQuotient((plan.counts.array() - 1).max(1).matrix().cast<double>());
      const Vector3d place = plan.middle + plan.size.cwiseProduct(share) - plan.size / 2;
      const Vector3d way = place - before;
      int sense = 1;
      for (const double each : way) {
        if (each != 0.0) {
          sense = each > 0.0 ? 1 : -1;
          break;
        }
      }
      begin += way.norm() / plan.feed;
      for (int reading = 0; reading < kReadings; ++reading) {
        maker.Add({begin + kStand * reading / kReadings, place, 1, sense, plan.feed});
      }
      begin += kStand;
      before = place;
    }
  }
  return maker.Take();
}

Recording StillPath(char axis, const Vector3d& at, const PathAbout& about) {
  constexpr double kInterval = 0.093;  // s: no multiple of the period of the mains
  constexpr int kReadings = 120;
  PathMaker maker({"dwell", about.machine, about.started, fmt::format("axis = \"{}\"\n", axis)},
                  about);
  for (int row = 0; row < kReadings; ++row) maker.Add({row * kInterval, at, 1, 0});
  return maker.Take();
}

Recording LengthPath(char axis, const Vector3d& middle, const machine::Travel& travel,
                     const PathAbout& about) {
  constexpr int kPlaces = 12;
  constexpr double kSeconds = 5.0;          // for each
  constexpr double kU = 0.1, kScale = 2.0;  // um, ppm
  PathMaker maker({"length", about.machine, about.started,
                   fmt::format("axis = \"{}\"\nu_scale_ppm = {}\n", axis, kScale)},
                  about);
  std::vector<double> lengths;
  for (int place = 0; place <= kPlaces; ++place) {
    Vector3d axes = middle;
    const double length = (travel.last - travel.first) * place / kPlaces;
    axes[axis - 'X'] = travel.first + length;
    maker.Add({kSeconds * place, axes, 1, 1});
    lengths.push_back(length / settings::kMillimetre);
  }
  Recording path = maker.Take();
  path.columns.push_back(
      {fmt::format("approach_{}", "xyz"[axis - 'X']), std::vector<double>(lengths.size(), 1.0)});
  path.columns.push_back({"u_length_um", std::vector<double>(lengths.size(), kU)});
  path.columns.push_back({"length_mm", std::move(lengths)});
  return path;
}

Recording BegunAt(Recording path, double started) {
  constexpr std::string_view kKey = "started = ";
  const std::size_t from = path.header.find(kKey);
  if (from == std::string::npos) return path;
  const std::size_t to = path.header.find('\n', from);
  path.header.replace(from, to - from,
                      fmt::format("{}{}", kKey, settings::Quoted(recording::InstantText(started))));
  return path;
}

double DurationOf(const Recording& recording) {
  const auto time = recording.Find("time_s");
  return time && !time->empty() ? time->back() - time->front() : 0.0;
}

}  // namespace abbe::simulation
