// A wheel that turns under gap sensors, by its own exact geometry: the place where the ray of a
// sensor meets a rim that is not round, not centred and does not turn about a fixed axis.
//
// The seed picks the noise, where the shaft starts, the zeros of the sensors, and whether the
// sensors are counted with or against the shaft. Channels speak at times of their own.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "random/counter_random.h"
#include "recording/recording.h"
#include "settings/document.h"

namespace abbe {

struct Wheel {
  std::vector<double> sensor_degrees{0.0, 120.0, 240.0};
  double radius = 0.2;                     // m
  double eccentricity = 0.0, phase = 0.0;  // m, rad: of its centre, shaft at 0
  double sin3 = 0.0, cos3 = 0.0;           // m: form of its rim
  double sin2x = 0.0, cos2y = 0.0;         // m: way of the axis of rotation
  std::vector<double> gain = std::vector<double>(5, 1.0);
  std::vector<double> quadratic = std::vector<double>(5, 0.0);  // per m
  double delay = 0.0;                                           // s: of the sensors
  double noise = 0.5e-6;                                        // m
  double rpm = 20.0, turns = 5.0;
};

class WheelUnderSensors {
 public:
  WheelUnderSensors(const Wheel& wheel, std::uint64_t seed)
      : wheel_(wheel), random_(seed, 21), sense_(seed % 2 == 0 ? 1.0 : -1.0) {}

  recording::Recording Record(const std::string& name) {
    const std::size_t sensors = wheel_.sensor_degrees.size();
    recording::Recording recording;
    recording.name = name;
    recording.header = fmt::format("kind = \"shaft\"\nsensor_deg = [{}]\n",
                                   fmt::join(wheel_.sensor_degrees, ", "));
    recording.columns = {{"time_s", {}}, {"shaft_deg", {}}};
    for (std::size_t s = 1; s <= sensors; ++s) {
      recording.columns.push_back({fmt::format("gap_{}_mm", s), {}});
    }
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr double kPace = 4e-3;  // s
    const double speed = wheel_.rpm / 60.0 * 2.0 * std::numbers::pi;
    const double start = 1.0;  // rad
    const double seconds = wheel_.turns * 60.0 / wheel_.rpm;
    for (double time = 0.0; time < seconds; time += kPace) {
      const double angle = start + speed * time;
      Row(recording, time, std::remainder(angle, 2.0 * std::numbers::pi),
          std::vector<double>(sensors, kNone));
      std::vector<double> gaps;
      const double late = time + 0.3 * kPace;
      for (std::size_t s = 0; s < sensors; ++s) {
        const double shaft = start + speed * (late - wheel_.delay);
        gaps.push_back(Shown(s, shaft) + wheel_.noise * random_.Normal(next_++));
      }
      Row(recording, late, kNone, gaps);
    }
    return recording;
  }

 private:
  static void Row(recording::Recording& recording, double time, double shaft,
                  const std::vector<double>& gaps) {
    recording.columns[0].values.push_back(time);
    recording.columns[1].values.push_back(shaft * 180.0 / std::numbers::pi);
    for (std::size_t s = 0; s < gaps.size(); ++s) {
      recording.columns[2 + s].values.push_back(1e3 * gaps[s]);
    }
  }

  double Shown(std::size_t sensor, double shaft) const {
    constexpr double kZero = 2e-3;
    const double place = sense_ * wheel_.sensor_degrees[sensor] * std::numbers::pi / 180.0;
    const double swing = wheel_.radius - Along(place, shaft);
    return kZero + wheel_.gain[sensor] * swing + wheel_.quadratic[sensor] * swing * swing;
  }

  // How far from the nominal axis of rotation the rim meets the ray of a sensor.
  double Along(double place, double shaft) const {
    const Eigen::Vector2d ray(std::cos(place), std::sin(place));
    const double out = wheel_.phase + shaft;
    const Eigen::Vector2d centre =
        wheel_.eccentricity * Eigen::Vector2d(std::cos(out), std::sin(out)) +
        Eigen::Vector2d(wheel_.sin2x * std::sin(2.0 * shaft), wheel_.cos2y * std::cos(2.0 * shaft));
    double along = wheel_.radius;
    for (int round = 0; round < 50; ++round) {
      const Eigen::Vector2d at = along * ray - centre;
      const double own = std::atan2(at.y(), at.x()) - shaft;
      const double radius =
          wheel_.radius + wheel_.sin3 * std::sin(3.0 * own) + wheel_.cos3 * std::cos(3.0 * own);
      along += radius - at.norm();
    }
    return along;
  }

  Wheel wheel_;
  random::CounterRandom random_;
  double sense_;
  std::uint64_t next_ = 0;
};

inline simulation::Instruments SetupOfWheel() {
  constexpr const char* kWheel = R"(
name = "wheel"
chain = "[w X Y b Z t]"
[axis]
X = {travel_mm = [0, 1], positive = "carriage"}
Y = {travel_mm = [0, 1], positive = "carriage"}
Z = {travel_mm = [0, 1]}
)";
  return {machine::ReadMachine(settings::Document::Parse(kWheel, "wheel.toml").Root()),
          std::nullopt,
          {},
          {},
          std::nullopt};
}

}  // namespace abbe
