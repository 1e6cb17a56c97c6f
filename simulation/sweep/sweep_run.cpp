#include "simulation/sweep/sweep_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "probes/sweep_dwells.h"
#include "probes/sweep_stations.h"
#include "recording/good_rows.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;

struct Sweep {
  SweepRun run;  // without rows
  probes::StationMeans means;
};

// A name, or a table [mounting] with an `id`.
std::string MountingOf(const recording::Recording& recording) {
  if (const auto id = recording.HeaderText("mounting.id")) return *id;
  return recording.HeaderText("mounting").value_or("");
}

Sweep ReadMeans(const recording::Recording& recording, const recording::Blocks& blocks,
                const probes::HeadSettings& head, const probes::ProbeNoise& noise,
                probes::ExcessNoise excess) {
  const auto dwells =
      probes::FindDwells(recording, blocks, probes::DwellRuleOf(recording), head.Ranges());
  const auto fitted = [&](probes::ExcessNoise how) {
    return probes::FitStations(recording.name, dwells, noise, how);
  };
  Sweep sweep{{}, fitted(excess)};
  // What scatters more without a reason that is seen is left to the robust loss of a map.
  if (excess == probes::ExcessNoise::kFitted && sweep.means.moves.empty() &&
      sweep.means.wild.empty() && sweep.means.noise.dof > 0.0) {
    sweep.means = fitted(probes::ExcessNoise::kScaled);
  }
  sweep.run.name = recording.name;
  sweep.run.mounting = MountingOf(recording);
  sweep.run.mounted = MountedOf(recording);
  sweep.run.axis = dwells.axis;
  sweep.run.start = dwells.start;
  return sweep;
}

Eigen::MatrixXd DriftCovariance(const Eigen::VectorXd& time, const probes::ProbeNoise& noise) {
  Eigen::MatrixXd covariance(time.size(), time.size());
  for (Index a = 0; a < time.size(); ++a) {
    covariance.col(a) =
        noise.drift * noise.drift * (-(time.array() - time[a]).abs() / noise.drift_time).exp();
  }
  return covariance;
}

Eigen::VectorXd ColumnOf(const recording::Recording& recording, const std::string& column,
                         const std::vector<std::size_t>& rows) {
  const std::vector<double> read = recording::ValuesOf(recording, column, rows);
  return Eigen::Map<const Eigen::VectorXd>(read.data(), read.size());
}

Eigen::Matrix3Xd AxesOf(const recording::Recording& recording,
                        const std::vector<std::size_t>& rows) {
  Eigen::Matrix3Xd axes(3, rows.size());
  for (Index k = 0; k < 3; ++k) {
    axes.row(k) = ColumnOf(recording, fmt::format("{}_mm", "xyz"[k]), rows).transpose();
  }
  return axes;
}

// What the means over two spans of time share of a process of variance 1 that forgets itself within
// `fades`: the integral of exp(-|s - t| / fades) over both.
double SharedByMeans(double apart, double span, double other, double fades) {
  const auto kept = [&](double of) {
    return of == 0.0 ? 1.0 : -std::expm1(-of / fades) * fades / of;
  };
  const double between = std::max(0.0, apart - 0.5 * (span + other));
  return kept(span) * kept(other) * std::exp(-between / fades);
}

double VarianceOfMean(double span, double fades) {
  constexpr double kShort = 1e-3;
  const double x = span / fades;
  return x < kShort ? 1.0 - x / 3.0 : 2.0 * (x + std::expm1(-x)) / (x * x);
}

// Between rows that are means; n readings stand for the time of n steps.
Eigen::MatrixXd MemoryCovariance(const SweepRun& run, double sd, double fades) {
  const Eigen::ArrayXd n = run.samples.array();
  const Eigen::ArrayXd spans = run.duration.array() * n / (n - 1.0).max(1.0);
  Eigen::MatrixXd covariance(run.rows(), run.rows());
  for (Index a = 0; a < run.rows(); ++a) {
    for (Index b = 0; b < a; ++b) {
      const double apart = std::abs(run.time[a] - run.time[b]);
      covariance(a, b) = covariance(b, a) =
          sd * sd * SharedByMeans(apart, spans[a], spans[b], fades);
    }
    covariance(a, a) = sd * sd * VarianceOfMean(spans[a], fades);
  }
  return covariance;
}

// The rows [first, last) of those that count.
struct Standstill {
  std::size_t first, last;
};

// One row of the run is the mean of one standstill.
SweepRun Standing(const recording::Recording& recording, const std::vector<std::size_t>& rows,
                  const std::vector<Standstill>& each, const probes::ProbeNoise& noise) {
  if (each.empty()) {
    throw InputError(fmt::format("{}: no row counts; record it again", recording.name));
  }
  const Index count = each.size();
  SweepRun run;
  run.name = recording.name;
  run.mounting = MountingOf(recording);
  run.mounted = MountedOf(recording);
  run.axis = recording.HeaderText("axis").value_or("X")[0];
  Eigen::VectorXd readings(count);
  for (Index row = 0; row < count; ++row) {
    const Standstill& stands = each[row];
    readings[row] = stands.last - stands.first;
    run.first_rows.push_back(rows[stands.first]);
  }
  const auto means = [&](const Eigen::MatrixXd& values) {
    Eigen::MatrixXd mean(values.rows(), count);
    for (Index row = 0; row < count; ++row) {
      const Index first = each[row].first;
      mean.col(row) = values.middleCols(first, static_cast<Index>(readings[row])).rowwise().mean();
    }
    return mean;
  };
  const Eigen::Matrix3Xd axes = means(AxesOf(recording, rows));
  const Index swept = run.axis - 'X';
  run.start = axes.col(0);
  run.position = axes.row(swept).transpose();
  run.steps = axes.colwise() - run.start;
  run.steps.row(swept).setZero();
  const Eigen::VectorXd time = ColumnOf(recording, "time_s", rows);
  run.time = means(time.transpose()).transpose();
  run.samples = readings;
  run.duration.resize(count);
  for (Index row = 0; row < count; ++row) {
    const Standstill& stands = each[row];
    run.duration[row] = time[stands.last - 1] - time[stands.first];
  }
  run.pass.assign(each.size(), 1);
  run.gap.resize(probes::kProbes, count);
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    const std::string column = fmt::format("probe_{}_um", static_cast<char>('a' + i));
    run.gap.row(i) = means(ColumnOf(recording, column, rows).transpose());
    run.covariance[i] = MemoryCovariance(run, noise.drift, noise.drift_time);
    if (noise.memory[i] > 0.0) {
      run.covariance[i] += MemoryCovariance(run, noise.memory[i], noise.memory_time[i]);
    }
    run.covariance[i].diagonal().array() += noise.Of(i) * noise.Of(i) / readings.array();
  }
  return run;
}

}  // namespace

SweepMounting MountedOf(const recording::Recording& recording) {
  const std::string head = recording.HeaderText("mounting.head").value_or("0deg");
  if (head != "0deg" && head != "180deg") {
    throw InputError(fmt::format(
        "{}: mounting.head is \"{}\"; a head is mounted as the machine file says, \"0deg\", or "
        "turned by half a turn, \"180deg\"",
        recording.name, head));
  }
  return {head == "180deg", 1e-3 * recording.HeaderNumber("mounting.target_shift_mm").value_or(0.0),
          recording.HeaderText("mounting.target_reversed").value_or("false") == "true",
          probes::ChannelOrderOf(recording)};
}

SweepRun ReadSweepRun(const recording::Recording& recording, const probes::HeadSettings& head,
                      const probes::ProbeNoise& noise) {
  return ReadSweepRun(
      recording, [&](const auto& use) { use(recording); }, head, noise);
}

SweepRun ReadSweepRun(const recording::Recording& recording, const recording::Blocks& blocks,
                      const probes::HeadSettings& head, const probes::ProbeNoise& noise) {
  auto [run, means] = ReadMeans(recording, blocks, head, noise, probes::ExcessNoise::kFitted);
  run.position = std::move(means.position);
  run.gap = std::move(means.gap);
  run.notes = probes::MoveNotes(run.axis, means);
  run.covariance = std::move(means.covariance);
  run.pass.assign(run.rows(), 0);
  run.time.resize(run.rows());
  run.samples = Eigen::VectorXd::Ones(run.rows());
  run.duration = Eigen::VectorXd::Zero(run.rows());
  const std::vector<int>& directions = means.directions;
  for (Index row = 0; row < run.rows(); ++row) {
    const int direction = directions[row % directions.size()];
    const std::size_t station = row / directions.size();
    const auto first =
        std::find_if(means.dwells.begin(), means.dwells.end(), [&](const probes::Dwell& dwell) {
          return dwell.station == station && dwell.direction == direction;
        });
    run.direction.push_back(direction);
    run.first_rows.push_back(first->first_row);
    run.time[row] = first->time;
  }
  return run;
}

SweepRun ReadSweepDwells(const recording::Recording& recording, const probes::HeadSettings& head,
                         const probes::ProbeNoise& noise) {
  auto [run, means] = ReadMeans(
      recording, [&](const auto& use) { use(recording); }, head, noise,
      probes::ExcessNoise::kScaled);
  const Index rows = means.dwells.size();
  run.position.resize(rows);
  run.time.resize(rows);
  run.samples.resize(rows);
  run.duration.resize(rows);
  run.gap.resize(probes::kProbes, rows);
  for (Index row = 0; row < rows; ++row) {
    const probes::Dwell& dwell = means.dwells[row];
    run.position[row] = dwell.position;
    run.time[row] = dwell.time;
    run.samples[row] = dwell.samples;
    run.duration[row] = dwell.duration;
    run.pass.push_back(dwell.pass);
    run.direction.push_back(dwell.direction);
    run.first_rows.push_back(dwell.first_row);
    for (std::size_t i = 0; i < probes::kProbes; ++i) {
      run.gap(i, row) = dwell.gap[i];
    }
  }
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    run.covariance[i] = DriftCovariance(run.time, noise);
    run.covariance[i].diagonal() += means.white.col(i);
  }
  return run;
}

SweepRun ReadStillReadings(const recording::Recording& recording, const probes::ProbeNoise& noise) {
  const std::vector<std::size_t> rows = recording::GoodRows(recording);
  const std::size_t single = std::min(rows.size(), kStillReadings);
  const std::size_t block = (rows.size() - single + kLaterBlocks - 1) / kLaterBlocks;
  std::vector<Standstill> each;
  for (std::size_t i = 0; i < single; ++i) each.push_back({i, i + 1});
  for (std::size_t i = single; i < rows.size(); i += block) {
    each.push_back({i, std::min(i + block, rows.size())});
  }
  SweepRun run = Standing(recording, rows, each, noise);
  run.direction.assign(each.size(), 0);
  run.steps.resize(3, 0);
  return run;
}

SweepRun ReadReadingsInStays(const recording::Recording& recording,
                             const std::vector<std::vector<std::size_t>>& stays,
                             const probes::ProbeNoise& noise) {
  constexpr double kUnknown = 10e-6;  // m: where a stay is
  constexpr std::size_t kMost = 2 * kStillReadings;
  std::vector<std::size_t> rows;
  std::vector<Standstill> each;
  std::vector<Index> starts;
  for (const auto& stay : stays) {
    if (rows.size() + stay.size() > kMost && !rows.empty()) break;
    starts.push_back(rows.size());
    for (std::size_t i = 0; i < std::min(stay.size(), kMost); ++i) {
      each.push_back({rows.size(), rows.size() + 1});
      rows.push_back(stay[i]);
    }
  }
  SweepRun run = Standing(recording, rows, each, noise);
  starts.push_back(run.rows());
  for (Eigen::MatrixXd& covariance : run.covariance) {
    for (std::size_t stay = 0; stay + 1 < starts.size(); ++stay) {
      const Index first = starts[stay], count = starts[stay + 1] - first;
      covariance.block(first, first, count, count).array() += kUnknown * kUnknown;
    }
  }
  run.steps.resize(3, 0);
  const auto pass = recording::ValuesOf(recording, "pass", rows);
  const auto direction = recording::ValuesOf(recording, "direction", rows);
  run.pass.assign(pass.begin(), pass.end());
  run.direction.assign(direction.begin(), direction.end());
  if (run.mounting.empty()) run.mounting = run.name;
  run.name += " (readings in stays)";
  return run;
}

SweepRun ReadGapSteps(const recording::Recording& recording, const probes::ProbeNoise& noise,
                      const Eigen::Matrix<double, 6, 3>& slopes) {
  constexpr double kStays = 5e-6;  // m: nearer rows are of one standstill
  constexpr double kPause = 0.5;   // s: rows farther apart are of two
  const std::vector<std::size_t> rows = recording::GoodRows(recording);
  const Eigen::Matrix3Xd axes = AxesOf(recording, rows);
  const Eigen::VectorXd time = ColumnOf(recording, "time_s", rows);
  std::vector<Standstill> each;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool stays = i > 0 && time[i] - time[i - 1] < kPause &&
                       (axes.col(i) - axes.col(i - 1)).cwiseAbs().maxCoeff() < kStays;
    if (stays) {
      each.back().last = i + 1;
    } else {
      each.push_back({i, i + 1});
    }
  }
  SweepRun run = Standing(recording, rows, each, noise);
  run.slopes = slopes;
  const auto direction = recording::ValuesOf(recording, "direction", run.first_rows);
  run.direction.assign(direction.begin(), direction.end());
  return run;
}

}  // namespace abbe::simulation
