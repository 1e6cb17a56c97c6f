#include "apps/align_result.h"

#include <fmt/format.h>

#include <cmath>

#include "settings/unit.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using probes::AlignSettings;
using probes::GapOutlook;
using settings::kMicrometre;
using settings::kMicroradian;
using settings::kMillimetre;

std::string ProbeName(std::size_t probe) { return fmt::format("probe_{:c}", 'a' + probe); }

std::string_view VerdictText(AlignEnd end) {
  switch (end) {
    case AlignEnd::kReady:
      return "ready";
    case AlignEnd::kGoesOn:
      return "goes on";
    case AlignEnd::kWrongWiring:
      return "wrong wiring";
    case AlignEnd::kOutOfReach:
      return "out of reach";
    case AlignEnd::kStopped:
      return "stopped";
  }
  return {};
}

ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json TurnsJson(const std::vector<probes::ScrewTurn>& turns, const AlignSettings& settings) {
  ordered_json list = ordered_json::array();
  for (const probes::ScrewTurn& turn : turns) {
    list.push_back({{"screw", settings.screws[turn.screw].name}, {"turns", turn.turns}});
  }
  return list;
}

ordered_json ReadingJson(const probes::GapsAt& at) {
  ordered_json gaps = ordered_json::array();
  for (const double gap : at.gap) gaps.push_back(NumberOrNull(gap));
  return {{"setting", at.setting}, {"travel", at.travel}, {"gap", gaps}};
}

// "8.0 um beyond the range", "12.0 um too near its end", "ok".
std::string RoomText(const GapOutlook& probe, double margin) {
  const double room = probe.Room();
  if (room < 0.0) return fmt::format("{:.1f} um beyond the range", -room / kMicrometre);
  if (room < margin) return fmt::format("{:.1f} um into the margin", (margin - room) / kMicrometre);
  return "ok";
}

}  // namespace

ordered_json AlignJson(const AlignStatus& status, const AlignSettings& settings) {
  ordered_json json = {{"abbe", ABBE_VERSION},
                       {"command", "align"},
                       {"axis", std::string(1, status.axis)},
                       {"machine", status.machine},
                       {"started", status.started},
                       {"simulated", status.simulated},
                       {"verdict", VerdictText(status.end)},
                       {"mounting", status.mounting},
                       {"travel", {status.first, status.last}},
                       {"margin", settings.margin},
                       {"adjustments", status.turned.size()}};
  if (status.alignment) {
    const probes::HeadAlignment& found = *status.alignment;
    json["seen"] = found.seen;
    json["tilt"] = {{"top", {{"value", found.top.value}, {"u", found.top.u}}},
                    {"side", {{"value", found.side.value}, {"u", found.side.u}}}};
    for (std::size_t i = 0; i < probes::kProbes; ++i) {
      const GapOutlook& now = found.now[i];
      json["gaps"][ProbeName(i)] = {
          {"first", now.first}, {"last", now.last},
          {"u", now.u},         {"range", now.range},
          {"room", now.Room()}, {"after", {found.after[i].first, found.after[i].last}}};
    }
    json["turns"] = TurnsJson(found.turns, settings);
  }
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    const probes::ChannelNoise& noise = status.noise[i];
    json["noise"][ProbeName(i)] = {{"white_m", NumberOrNull(noise.noise)},
                                   {"mains_m", noise.mains},
                                   {"mains_hz", noise.mains_hz}};
  }
  json["turned"] = ordered_json::array();
  for (const auto& turns : status.turned) json["turned"].push_back(TurnsJson(turns, settings));
  json["readings"] = ordered_json::array();
  for (const auto& at : status.readings) json["readings"].push_back(ReadingJson(at));
  json["wiring"] = status.wiring;
  json["not_excluded"] = status.open;
  json["notes"] = status.notes;
  return json;
}

std::string AlignTable(const AlignStatus& status, const AlignSettings& settings) {
  const probes::HeadAlignment& found = *status.alignment;
  std::string text = fmt::format(
      "{:c}, {:.0f} % of the travel seen; top face rises {:+.0f} urad along {:c}, side face {:+.0f} "
      "urad\n{:8} {:>10} {:>10} {:>8} {:>9}\n",
      status.axis, 100.0 * found.seen, found.top.value / kMicroradian, status.axis,
      found.side.value / kMicroradian, "gap, um",
      fmt::format("{:.6g} mm", status.first / kMillimetre),
      fmt::format("{:.6g} mm", status.last / kMillimetre), "range", "noise, nm");
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    const GapOutlook& probe = found.now[i];
    text +=
        fmt::format("{:8} {:10.1f} {:10.1f} {:8.0f} {:9.0f}  {}\n", ProbeName(i),
                    probe.first / kMicrometre, probe.last / kMicrometre, probe.range / kMicrometre,
                    status.noise[i].noise / settings::kNanometre, RoomText(probe, settings.margin));
  }
  return text;
}

std::vector<std::string> TurnLines(std::span<const probes::ScrewTurn> turns,
                                   const probes::HeadAlignment& alignment,
                                   const AlignSettings& settings) {
  std::vector<std::string> lines;
  for (const probes::ScrewTurn& turn : turns) {
    lines.push_back(fmt::format("{} {:.2f} turns {}", settings.screws[turn.screw].name,
                                std::abs(turn.turns),
                                turn.turns > 0.0 ? "clockwise" : "counter-clockwise"));
  }
  if (!settings.screws.empty()) return lines;
  const auto& motion = alignment.motion;
  lines.push_back(
      fmt::format("move the target by {:+.1f} um along n (away from its top face) and "
                  "{:+.1f} um along s (away from its side face)",
                  motion[2] / kMicrometre, motion[1] / kMicrometre));
  lines.push_back(
      fmt::format("turn it by {:+.0f} urad about u, {:+.0f} urad about s, {:+.0f} urad "
                  "about n, through its corner",
                  motion[3] / kMicroradian, motion[4] / kMicroradian, motion[5] / kMicroradian));
  return lines;
}

std::vector<std::string> NoiseNotes(const probes::PerProbe<probes::ChannelNoise>& noise,
                                    double stated) {
  constexpr double kLoud = 5.0;
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    const probes::ChannelNoise& one = noise[i];
    if (one.constant) {
      notes.push_back(fmt::format(
          "{} shows no noise at all, as no probe does: another register is read, or the amplifier "
          "is off",
          ProbeName(i)));
    } else if (stated > 0.0 && one.noise > kLoud * stated) {
      notes.push_back(fmt::format(
          "{} is noisy: {:.0f} nm a reading, noise.probe_nm says {:.0f}: look at its cable and "
          "what vibrates",
          ProbeName(i), one.noise / settings::kNanometre, stated / settings::kNanometre));
    }
    if (one.mains > std::max(stated, one.noise)) {
      notes.push_back(fmt::format(
          "{} picks up the mains: {:.0f} nm at {:.0f} Hz: connect the screen of its cable, and the "
          "target, to the earth of the amplifier",
          ProbeName(i), one.mains / settings::kNanometre, one.mains_hz));
    }
  }
  return notes;
}

}  // namespace abbe::apps
