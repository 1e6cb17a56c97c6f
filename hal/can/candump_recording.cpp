#include "hal/can/candump_recording.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <memory>
#include <span>
#include <utility>

#include "failure/failure.h"
#include "hal/can/can_replay.h"
#include "hal/can/canopen_frame.h"
#include "hal/can/canopen_source.h"
#include "hal/sample_flag.h"
#include "settings/toml_text.h"

namespace abbe::hal {
namespace {

constexpr double kFrameApart = 1e-6;  // s, the resolution of a log
// s without a frame after which no rows stand for the silence: a clock that was set makes decades.
constexpr double kLongestSilence = 60.0;

std::string HeaderOf(const CandumpLog& log, const CanopenSettings& device,
                     const std::string& machine) {
  const auto started = log.started_us / 1'000'000;
  return fmt::format(
      "kind = \"dwell\"\nmachine = {}\nstarted = {:%Y-%m-%dT%H:%M:%S}.{:06}Z\n[sources]\n"
      "{} = {}\n",
      settings::Quoted(machine), fmt::gmtime(started), log.started_us % 1'000'000,
      settings::Key(device.name), settings::Quoted("candump: " + device.interface));
}

// The start of a recording in microseconds since 1970; 0 where its header has none.
std::int64_t StartOf(const recording::Recording& recording) {
  const std::string text = recording.HeaderText("started").value_or("");
  std::tm day{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &day);
  if (rest == nullptr) return 0;
  const double fraction = *rest == '.' ? std::strtod(rest, nullptr) : 0.0;
  return std::int64_t{timegm(&day)} * 1'000'000 + std::llround(1e6 * fraction);
}

}  // namespace

recording::Recording RecordingOf(const CandumpLog& log, const CanopenSettings& device,
                                 double stale_s, const std::string& machine) {
  HandClock clock;
  auto replayed = std::make_unique<CanReplay>(log, device.interface, clock);
  const CanReplay& replay = *replayed;
  CanopenSource source(device, stale_s, std::move(replayed), clock, {},
                       CanopenSource::Part::kListener);
  recording::Recording recording{log.name, HeaderOf(log, device, machine), {}, log.warnings};
  recording.columns.push_back({"time_s", {}});
  for (const Channel& channel : source.channels()) recording.columns.push_back({channel.name, {}});
  recording.columns.push_back({"flags", {}});
  bool any_good = false;
  while (!source.Ended()) {
    if (const double silence = replay.NextTime() - clock.Now(); silence > kLongestSilence) {
      recording.warnings.push_back(fmt::format(
          "{}: no frame of {} for {:.0f} s from second {:.0f} on, for which no rows stand: the bus "
          "was silent, or the computer's calendar was set",
          log.name, device.interface, silence, clock.Now()));
      clock.SleepUntil(replay.NextTime() - 1.0);
    }
    const SampleSet set = source.Read();
    std::uint32_t flags = 0;
    for (std::size_t i = 0; i < set.samples.size(); ++i) {
      flags |= FlagOf(set.samples[i].cause);
      recording.columns[i + 1].values.push_back(set.samples[i].value);
      any_good = any_good || set.samples[i].good();
    }
    recording.columns.front().values.push_back(set.time_s);
    recording.columns.back().values.push_back(flags);
  }
  if (any_good) return recording;
  throw InputError(fmt::format(
      "{}: no encoder of device \"{}\" gives a good angle in it{}{}; check its nodes, their PDOs "
      "and ranges in the machine file",
      log.name, device.name, source.Fault().empty() ? "" : ": ", source.Fault()));
}

CandumpLog LogOf(const recording::Recording& recording, const CanopenSettings& device) {
  CandumpLog log;
  log.name = recording.name;
  log.started_us = StartOf(recording);
  std::vector<std::span<const double>> angles;
  for (const EncoderSettings& encoder : device.encoders) {
    angles.push_back(recording.At(encoder.name));
  }
  const auto times = recording.At("time_s");
  for (std::size_t row = 0; row < times.size(); ++row) {
    double time = times[row];
    log.frames.push_back({time, device.interface, SyncFrame()});
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const double angle = angles[i][row];
      if (!std::isfinite(angle)) continue;
      const EncoderSettings& encoder = device.encoders[i];
      CanFrame frame{.id = TpdoId(encoder.tpdo, encoder.node)};
      PutBits(frame, encoder.at_bit, encoder.bits, CountOf(encoder, angle));
      log.frames.push_back({time += kFrameApart, device.interface, frame});
    }
  }
  return log;
}

}  // namespace abbe::hal
