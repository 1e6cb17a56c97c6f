#include "apps/growing_sweep.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "apps/reduce_sweep.h"
#include "failure/failure.h"

namespace abbe::apps {
namespace {

constexpr std::size_t kFewestVisits = 4;
constexpr double kShare = 20.0;  // durations of a reduction between two

// The rows of `whole` for which `keep` is true of pass and direction.
recording::Recording Part(recording::Recording whole,
                          const std::function<bool(double pass, double direction)>& keep) {
  const auto pass = whole.At("pass");
  const auto direction = whole.At("direction");
  std::vector<bool> kept;
  for (std::size_t row = 0; row < whole.rows(); ++row) {
    kept.push_back(keep(pass[row], direction[row]));
  }
  for (recording::Column& column : whole.columns) {
    std::size_t count = 0;
    for (std::size_t row = 0; row < kept.size(); ++row) {
      if (kept[row]) column.values[count++] = column.values[row];
    }
    column.values.resize(count);
  }
  return whole;
}

}  // namespace

GrowingSweep::GrowingSweep(LiveView* view, const hal::SweepPlan& plan,
                           const probes::SweepSetup& setup, std::filesystem::path recording)
    : view_(view), plan_(plan), setup_(setup), recording_(std::move(recording)) {
  if (view_ == nullptr) return;
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

GrowingSweep::~GrowingSweep() { Finish(); }

void GrowingSweep::Finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void GrowingSweep::Run(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  std::size_t reduced = 0;
  double wait_s = 0.5;
  while (!wake.wait_for(lock, stop, std::chrono::duration<double>(wait_s), [] { return false; }) &&
         !stop.stop_requested()) {
    const std::size_t visits = visits_;
    if (visits < kFewestVisits || visits == reduced) continue;
    reduced = visits;
    const auto begin = Clock::now();
    try {
      Reduce(visits);
    } catch (const Failure&) {
      // Too few stations yet; a file that is wrong is said at the end of the sweep.
    }
    const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    wait_s = std::max(0.5, kShare * took_s);
  }
}

void GrowingSweep::Reduce(std::size_t visits) {
  const std::size_t stations = plan_.stations.size();
  const std::size_t passes = visits / (2 * stations);
  const std::size_t whole = passes > 0 ? 2 * stations * passes : std::min(visits, stations);
  recording::Recording rows = Part(recording::Read(recording_), [&](double pass, double direction) {
    return passes > 0 ? pass <= static_cast<double>(passes) : pass == 1.0 && direction > 0.0;
  });
  nlohmann::ordered_json json = SweepJson(probes::ReduceSweep(rows, setup_));
  json["partial"] = fmt::format("{} of {} visits", whole, 2 * stations * plan_.passes);
  view_->Show(recording_.stem().string() + ".json", json);
}

}  // namespace abbe::apps
