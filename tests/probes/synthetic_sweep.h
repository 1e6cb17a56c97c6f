// Recordings of a sweep whose truth is written down: a machine, a head and five error functions,
// read through the rigid model without the inversion, with white noise and drift where wanted.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "probes/head_model.h"
#include "probes/installation.h"
#include "probes/sweep_reduction.h"
#include "random/counter_random.h"
#include "recording/recording.h"

namespace abbe::probes {

inline constexpr char kTestMachine[] = R"(
name = "test-mill"
chain = "[w X Y b Z t]"
reference_mm = [3.0, -4.0, 5.0]
[axis.X]
travel_mm = [0.0, 60.0]
positive = "carriage"
[axis.Y]
travel_mm = [0.0, 60.0]
positive = "carriage"
[axis.Z]
travel_mm = [0.0, 60.0]
[head.axis_X]
position_mm = [20.0, 15.0, 40.0]
[head.axis_Y]
position_mm = [20.0, 15.0, 40.0]
[head.axis_Z]
position_mm = [20.0, 15.0, 40.0]
[target]
u_squareness_urad = 2.0
)";

inline SweepSetup TestSetup(const std::string& text = kTestMachine) {
  return ReadSweepSetup(settings::Document::Parse(text, "test.toml").Root());
}

struct SyntheticSweep {
  char axis = 'X';
  MovingBody moving = MovingBody::kTarget;
  double first = 0.0, step = 5e-3;  // m
  int stations = 13;
  int passes = 5;
  int samples = 60;  // per dwell, besides 20 settling
  bool backward = true;
  double white = 0.0;                               // m
  double drift = 0.0;                               // m, Ornstein-Uhlenbeck, 600 s
  double tilt_u = 0.0, tilt_s = 0.0, tilt_n = 0.0;  // rad, of the target's faces in H
  std::uint64_t seed = 1;
  std::string header = "";
  // Errors in H at the travel d, approached in this direction.
  std::function<HeadErrors<>(double d, int direction)> errors = [](double d, int) {
    const double phase = 2.0 * std::numbers::pi * d / 40e-3;
    HeadErrors<> e;
    e.eax = 15e-6 * std::sin(phase);
    e.ebx = -20e-6 * (std::cos(phase) - 1.0);
    e.ecx = 10e-6 * std::sin(2.0 * phase);
    e.eyx = 1e-6 * std::sin(phase + 0.3);
    e.ezx = -2e-6 * std::cos(phase);
    return e;
  };
};

// The drift of each probe, exact from one time to the next.
class SyntheticDrift {
 public:
  SyntheticDrift(double sd, std::uint64_t seed) : sd_(sd), random_(seed, 99) {
    for (double& value : at_) value = sd_ * random_.Normal(index_++);
  }
  void Step(double seconds) {
    if (sd_ == 0.0) return;
    const double kept = std::exp(-seconds / 600.0);
    for (double& value : at_) {
      value = kept * value + sd_ * std::sqrt(1.0 - kept * kept) * random_.Normal(index_++);
    }
  }
  double operator[](std::size_t probe) const { return at_[probe]; }

 private:
  double sd_;
  random::CounterRandom random_;
  std::uint64_t index_ = 0;
  PerProbe<> at_{};
};

class SyntheticRecorder {
 public:
  SyntheticRecorder(const SyntheticSweep& sweep, const SweepSetup& setup)
      : sweep_(sweep),
        lines_(InstalledLines(setup.head.layout, setup.head.installation)),
        noise_(sweep.seed, 1),
        drift_(sweep.drift, sweep.seed) {
    recording_.name = fmt::format("synthetic_{}.csv", sweep.axis);
    recording_.header = fmt::format("kind = \"sweep\"\nmachine = \"test-mill\"\naxis = \"{}\"\n{}",
                                    sweep.axis, sweep.header);
    for (const char* name :
         {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min", "probe_a_um",
          "probe_b_um", "probe_c_um", "probe_d_um", "probe_e_um", "temp_column_c", "flags"}) {
      recording_.columns.push_back({name, {}});
    }
  }

  recording::Recording Run() {
    for (int pass = 1; pass <= sweep_.passes; ++pass) {
      for (const int direction : {+1, -1}) {
        if (direction < 0 && !sweep_.backward) continue;
        for (int k = 0; k < sweep_.stations; ++k) {
          const int station = direction > 0 ? k : sweep_.stations - 1 - k;
          const double position = sweep_.first + station * sweep_.step;
          for (int i = 12; i > 0; --i) Row(position - direction * i * 50e-6, pass, direction);
          for (int i = 0; i < 20 + sweep_.samples; ++i) Row(position, pass, direction);
        }
      }
    }
    return recording_;
  }

 private:
  void Row(double position, int pass, int direction) {
    const double d = position - sweep_.first;
    PerProbe<> delta = RigidReadings(lines_, sweep_.moving, sweep_.errors(d, direction), d);
    // A tilted face is higher by its slope where it is farther along u.
    const double along = sweep_.moving == MovingBody::kTarget ? -d : d;
    std::vector<double> row = {time_, 0.0, 0.0, 0.0, 1.0 * pass, 1.0 * direction, 600.0};
    row[static_cast<std::size_t>(1 + sweep_.axis - 'X')] = position * 1e3;
    for (std::size_t p = 0; p < kProbes; ++p) {
      delta[p] += (p < kTopProbes ? -sweep_.tilt_s : sweep_.tilt_n) * along;
      const double noise = sweep_.white * noise_.Normal(index_++) + drift_[p];
      row.push_back((100e-6 - delta[p] + noise) * 1e6);
    }
    row.push_back(20.0 + 1e-3 * time_);
    row.push_back(0.0);
    for (std::size_t c = 0; c < row.size(); ++c) recording_.columns[c].values.push_back(row[c]);
    time_ += 0.005;
    drift_.Step(0.005);
  }

  SyntheticSweep sweep_;
  MeasuringLines<> lines_;
  random::CounterRandom noise_;
  SyntheticDrift drift_;
  std::uint64_t index_ = 0;
  double time_ = 0.0;
  recording::Recording recording_;
};

inline recording::Recording Record(const SyntheticSweep& sweep, const SweepSetup& setup) {
  return SyntheticRecorder(sweep, setup).Run();
}

}  // namespace abbe::probes
