// Synthetic sweeps whose readings are changed in time, against their written truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {

// In the columns of SyntheticRecorder.
inline constexpr std::size_t kTimeColumn = 0, kPassColumn = 4, kDirectionColumn = 5,
                             kFirstGapColumn = 7;

// The file states no other source of uncertainty than noise.
inline SweepSetup SetupOfNoiseOnly() {
  SweepSetup setup = TestSetup();
  setup.head.tolerance = {};
  setup.target.form = 0.0;
  return setup;
}

// Adds to each gap, um, what `change` returns for its time as a share of the run.
inline recording::Recording WithAdded(
    recording::Recording recording,
    const std::function<double(std::size_t probe, double share)>& change) {
  const std::vector<double>& time = recording.columns[kTimeColumn].values;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    std::vector<double>& gap = recording.columns[kFirstGapColumn + probe].values;
    for (std::size_t i = 0; i < gap.size(); ++i) gap[i] += change(probe, time[i] / time.back());
  }
  return recording;
}

// The share of the stations at which the angles of an X axis and its straightnesses at the target
// are within U95 of the truth.
class InsideU95 {
 public:
  void Add(const SyntheticSweep& sweep, const SweepResult& result) {
    using Error = double HeadErrors<>::*;
    constexpr Error kErrors[] = {&HeadErrors<>::eax, &HeadErrors<>::ebx, &HeadErrors<>::ecx,
                                 &HeadErrors<>::eyx, &HeadErrors<>::ezx};
    for (std::size_t c = 0; c < kComponents; ++c) {
      Eigen::VectorXd truth(sweep.stations);
      for (int i = 0; i < sweep.stations; ++i) {
        const double d = i * sweep.step;
        truth[i] = 0.5 * (sweep.errors(d, 1).*kErrors[c] + sweep.errors(d, -1).*kErrors[c]);
      }
      const ComponentResult& found = result.components[c];
      if (found.component.angle()) {
        Count(found.value - (truth.array() - truth[0]).matrix(), found.coverage * found.u, 1);
      } else {
        Count(found.at_target - FromItsLine(truth), found.coverage * found.u_at_target, 0);
      }
    }
  }
  double share() const { return inside_ / all_; }

 private:
  static Eigen::VectorXd FromItsLine(const Eigen::VectorXd& values) {
    Eigen::MatrixXd A(values.size(), 2);
    A.col(0).setOnes();
    A.col(1).setLinSpaced(0.0, 1.0);
    return values - A * A.colPivHouseholderQr().solve(values);
  }
  void Count(const Eigen::VectorXd& error, const Eigen::VectorXd& U95, Eigen::Index first) {
    for (Eigen::Index i = first; i < error.size(); ++i) {
      inside_ += std::abs(error[i]) <= U95[i] ? 1.0 : 0.0;
      all_ += 1.0;
    }
  }

  double inside_ = 0.0, all_ = 0.0;
};

inline bool Tells(const SweepResult& result, const std::string& words) {
  return std::ranges::any_of(
      result.notes, [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

}  // namespace abbe::probes
