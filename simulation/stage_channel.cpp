#include "simulation/stage_channel.h"

#include <algorithm>

#include "machine/error_motion.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

Instrument InstrumentOf(const Trace& trace) {
  if (trace.rim) return kFeltAtRim;
  return trace.head ? kFeltByProbes : kFeltByLinkage;
}

bool StageChannel::IsPlausible(double amount) const {
  constexpr double kMost = 1e-3;  // m
  return unit.name != estimation::kMicrometres.name || amount < kMost;
}

namespace {

StageChannel ErrorMotion(int axis, int motion) {
  const bool own = motion == axis;
  return {own ? std::string(1, "XYZ"[axis]) : machine::MotionName(axis, motion),
          MotionStage(axis, motion),
          motion < 3 ? estimation::kMicrometres : estimation::kMicroradians,
          kFeltByProbes | kFeltByLinkage};
}

StageChannel Ball(int i) {
  return {std::string("ball_") + "xyz"[i], kTipStage + i, estimation::kMicrometres, kFeltByLinkage};
}

StageChannel Reading(const Object& sensor) {
  const bool at_shaft = sensor.kind() == Object::Kind::kSensor;
  return {sensor.name(), kReadingStage + sensor.first(), estimation::kMicrometres,
          static_cast<unsigned>(at_shaft ? kFeltAtRim : kFeltByProbes)};
}

StageChannel Encoder(const Object& pivot) {
  return {pivot.name(), kEncoderStage + pivot.first(), estimation::kMicroradians, kFeltByLinkage};
}

}  // namespace

std::vector<StageChannel> ChannelsOf(const Scene& scene) {
  std::vector<StageChannel> channels;
  for (const Object& probe : ProbesOf(scene)) channels.push_back(Reading(probe));
  for (const Object& pivot : PivotsOf(scene)) channels.push_back(Encoder(pivot));
  if (scene.travel.isZero(0.0)) return channels;
  for (const Object& axis : AxesOf(scene)) {
    channels.push_back(ErrorMotion(axis.first(), axis.first()));
  }
  for (const Object& axis : AxesOf(scene)) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      if (motion != axis.first()) channels.push_back(ErrorMotion(axis.first(), motion));
    }
  }
  if (scene.Pivots() > 0) {
    for (int i = 0; i < 3; ++i) channels.push_back(Ball(i));
  }
  for (const Object& sensor : RimSensorsOf(scene)) channels.push_back(Reading(sensor));
  return channels;
}

std::optional<StageChannel> ChannelNamed(const std::string& name) {
  const Object object(name);
  switch (object.kind()) {
    case Object::Kind::kProbe:
    case Object::Kind::kSensor:
      return Reading(object);
    case Object::Kind::kPivot:
      return Encoder(object);
    case Object::Kind::kAxis:
      return ErrorMotion(object.first(), object.first());
    default:
      break;
  }
  for (int i = 0; i < 3; ++i) {
    if (name == Ball(i).object) return Ball(i);
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      if (motion != i && name == machine::MotionName(i, motion)) return ErrorMotion(i, motion);
    }
  }
  return {};
}

}  // namespace abbe::simulation
