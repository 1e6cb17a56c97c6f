#include "hal/can/canopen_settings.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <set>

namespace abbe::hal {
namespace {

using settings::Table;

constexpr double kMostNodes = 127.0, kMostBits = 48.0, kPdoBits = 64.0;

EncoderSettings ReadEncoder(const Table& table) {
  EncoderSettings encoder;
  encoder.name = table.Text("name");
  if (!encoder.name.ends_with("_rad")) {
    throw table.Error("name", "must end in _rad: an encoder gives an angle, as in \"pivot_1_rad\"");
  }
  const auto integer = [&](const char* key, const settings::NumberRule& rule) {
    return static_cast<int>(table.Integer(key, rule));
  };
  encoder.node = integer("id", {.at_least = 1.0, .at_most = kMostNodes});
  encoder.tpdo = integer("tpdo", {.fallback = 1.0, .at_least = 1.0, .at_most = 4.0});
  encoder.at_bit = integer("at_bit", {.fallback = 0.0, .at_least = 0.0, .at_most = kPdoBits - 1});
  encoder.bits = integer("bits", {.fallback = 32.0, .at_least = 1.0, .at_most = kMostBits});
  if (encoder.at_bit + encoder.bits > kPdoBits) {
    throw table.Error("bits", "reaches beyond the 64 bits of a PDO");
  }
  encoder.is_signed = table.Truth("signed", false);
  encoder.counts_per_turn = table.Number("counts_per_turn", {.above = 0.0});
  const double most = std::ldexp(1.0, encoder.bits);
  encoder.range = table.Integer("range", {.fallback = most, .at_least = 2.0, .at_most = most});
  if (encoder.range < encoder.counts_per_turn) {
    throw table.Error("range", fmt::format("{} is less than one turn of {} counts", encoder.range,
                                           encoder.counts_per_turn));
  }
  encoder.sense = integer("sense", {.fallback = 1.0, .at_least = -1.0, .at_most = 1.0});
  if (encoder.sense == 0) throw table.Error("sense", "must be 1 or -1");
  encoder.zero = table.Integer("zero", {.fallback = 0.0});
  encoder.fastest = table.Quantity("fastest_rad_s", {.fallback = 20.0, .above = 0.0});
  encoder.may_freeze = table.Truth("may_freeze", true);
  if (table.Has("serial")) {
    encoder.serial = static_cast<std::uint32_t>(
        table.Integer("serial", {.at_least = 0.0, .at_most = 0xFFFFFFFF}));
  }
  table.RefuseUnknown();
  return encoder;
}

}  // namespace

double EncoderSettings::Step() const { return 2.0 * std::numbers::pi / counts_per_turn; }

CanopenSettings ReadCanopen(const Table& device) {
  CanopenSettings settings;
  settings.name = device.key();
  settings.interface = device.Text("interface");
  settings.times.sync =
      device.Quantity("sync_ms", {.fallback = 1.0, .at_least = 0.0, .at_most = 1000.0});
  settings.times.answer =
      device.Quantity("answer_timeout_ms", {.fallback = 20.0, .above = 0.0, .at_most = 1000.0});
  settings.times.heartbeat = device.Quantity(
      "heartbeat_timeout_ms", {.fallback = 500.0, .at_least = 0.0, .at_most = 60'000.0});
  std::set<int> ids;
  for (const Table& node : device.Children("node")) {
    settings.encoders.push_back(ReadEncoder(node));
    if (ids.insert(settings.encoders.back().node).second) continue;
    throw node.Error("id", fmt::format("{} is used twice on this bus; each node has its own",
                                       settings.encoders.back().node));
  }
  if (settings.encoders.empty()) {
    throw device.Error("node", "is missing; there is at least one encoder");
  }
  return settings;
}

std::int64_t CountOf(const EncoderSettings& encoder, double angle) {
  const double turned = std::fmod(angle / encoder.Step(), encoder.range);
  const std::int64_t count = encoder.zero + encoder.sense * std::llround(turned);
  const std::int64_t wrapped = Wrapped(encoder, count);
  return encoder.is_signed || wrapped >= 0 ? wrapped : wrapped + encoder.range;
}

std::int64_t Wrapped(const EncoderSettings& encoder, std::int64_t counts) {
  const std::int64_t half = encoder.range / 2;
  std::int64_t rest = (counts + half) % encoder.range;
  if (rest < 0) rest += encoder.range;
  return rest - half;
}

}  // namespace abbe::hal
