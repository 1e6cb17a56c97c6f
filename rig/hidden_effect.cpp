#include "rig/hidden_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "rig/effects/registry.h"
#include "rig/rig_settings.h"
#include "rig/streams.h"
#include "settings/nearest_word.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

constexpr double kOpen = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kDrawsOfInstants = 100;  // index, after those of the keys

struct Object {
  ObjectKind kind;
  std::vector<int> places;
};

const std::map<std::string, Object>& Objects() {
  static const std::map<std::string, Object> objects = [] {
    std::map<std::string, Object> all = {
        {"X", {kAxisObject, {0}}},          {"Y", {kAxisObject, {1}}},
        {"Z", {kAxisObject, {2}}},          {"XY", {kPairObject, {0, 1}}},
        {"XZ", {kPairObject, {0, 2}}},      {"YZ", {kPairObject, {1, 2}}},
        {"pivot_1", {kPivotObject, {0}}},   {"pivot_2", {kPivotObject, {1}}},
        {"pivot_3", {kPivotObject, {2}}},   {"link_1", {kLinkObject, {0}}},
        {"link_2", {kLinkObject, {1}}},     {"head", {kHeadObject, {0}}},
        {"target_top", {kFaceObject, {0}}}, {"target_side", {kFaceObject, {1}}},
        {"cap", {kCapObject, {0}}},         {"probes", {kSourceObject, {0}}},
        {"linkage", {kSourceObject, {1}}},
    };
    for (int i = 0; i < kProbes; ++i) {
      const auto first = fmt::format("probe_{:c}", 'a' + i);
      all[first] = {kProbeObject, {i}};
      for (int k = 0; k < kProbes; ++k) {
        if (k != i) all[fmt::format("{}+probe_{:c}", first, 'a' + k)] = {kProbePairObject, {i, k}};
      }
    }
    return all;
  }();
  return objects;
}

std::vector<std::string> ObjectsOf(unsigned kinds) {
  std::vector<std::string> names;
  for (const auto& [name, object] : Objects()) {
    if ((object.kind & kinds) != 0) names.push_back(name);
  }
  return names;
}

std::vector<std::string> Split(std::string_view text) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t colon = text.find(':');
    parts.emplace_back(text.substr(0, colon));
    if (colon == std::string_view::npos) return parts;
    text.remove_prefix(colon + 1);
  }
}

// The key=value pairs of one --hide; Take removes a used one.
class Given {
 public:
  Given(std::string_view text, const std::vector<std::string>& parts) : text_(text) {
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const std::size_t equals = parts[i].find('=');
      if (equals == std::string::npos) {
        throw Error(fmt::format("\"{}\" is no key=value", parts[i]));
      }
      values_[parts[i].substr(0, equals)] = parts[i].substr(equals + 1);
    }
  }

  InputError Error(const std::string& what) const {
    return InputError(fmt::format("--hide {}: {}", text_, what));
  }

  // Empty when it was not given.
  std::string Take(const std::string& key) {
    const auto found = values_.find(key);
    if (found == values_.end()) return {};
    std::string value = std::move(found->second);
    values_.erase(found);
    return value;
  }

  double Number(const std::string& key, const std::string& value) const {
    double number = 0.0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size() || !std::isfinite(number)) {
      throw Error(fmt::format("{}={} is no number", key, value));
    }
    return number;
  }

  void RefuseRest(const std::vector<std::string>& known) const {
    if (values_.empty()) return;
    const std::string& key = values_.begin()->first;
    throw Error(fmt::format("\"{}\" is no key of this cause; did you mean \"{}\"?", key,
                            settings::NearestWord(key, known)));
  }

 private:
  std::string text_;
  std::map<std::string, std::string> values_;
};

// The entry of a cause for an object.
const Effect& EntryOf(const std::string& cause, const std::string& object, const Given& given) {
  std::vector<std::string> names;
  unsigned kinds = 0;
  for (const Effect& entry : EffectCatalogue()) {
    names.emplace_back(entry.name);
    if (entry.name == cause) kinds |= entry.objects;
  }
  if (kinds == 0) {
    throw given.Error(fmt::format("\"{}\" is no cause; did you mean \"{}\"?", cause,
                                  settings::NearestWord(cause, names)));
  }
  const std::vector<std::string> objects = ObjectsOf(kinds);
  if (std::find(objects.begin(), objects.end(), object) == objects.end()) {
    throw given.Error(object.empty()
                          ? fmt::format("has no object; add object={}", objects.front())
                          : fmt::format("\"{}\" is no object of this cause; did you mean \"{}\"?",
                                        object, settings::NearestWord(object, objects)));
  }
  const unsigned kind = Objects().at(object).kind;
  const auto found = std::find_if(
      EffectCatalogue().begin(), EffectCatalogue().end(),
      [&](const Effect& entry) { return entry.name == cause && (entry.objects & kind) != 0; });
  return *found;
}

double Drawn(const KeyEntry& key, const random::CounterRandom& random, std::uint64_t index) {
  const double share = random.Uniform(index);
  switch (key.draw) {
    case Draw::kUniform:
      return key.low + share * (key.high - key.low);
    case Draw::kEven:
      return key.low * std::pow(key.high / key.low, share);
    case Draw::kEvenSigned:
      return (random.Bits(index)[3] % 2 == 0 ? 1.0 : -1.0) * key.low *
             std::pow(key.high / key.low, share);
    case Draw::kWhole:
      return std::floor(key.low + share * (key.high + 1.0 - key.low));
    case Draw::kEither:
      return share < 0.5 ? key.low : key.high;
    case Draw::kInstant:
    case Draw::kTurn:
      return kOpen;
  }
  return kOpen;
}

std::string SensorOf(Given& given, const std::vector<std::string>& sensors) {
  const std::string sensor = given.Take("sensor");
  if (sensors.empty()) throw given.Error("the machine file has no temperature that it follows");
  if (sensor.empty()) return sensors.front();
  if (std::find(sensors.begin(), sensors.end(), sensor) != sensors.end()) return sensor;
  throw given.Error(fmt::format("\"{}\" is no temperature that it follows; did you mean \"{}\"?",
                                sensor, settings::NearestWord(sensor, sensors)));
}

void Check(const HiddenEffect& effect, const Given& given) {
  const auto require = [&](const char* key, bool fits, const char* wanted) {
    if (!fits) throw given.Error(fmt::format("{} must be {}", key, wanted));
  };
  for (const auto& [key, value] : effect.values) {
    const bool whole = key == "order" || key == "count" || key == "axis";
    if (whole) require(key.c_str(), value >= 1.0 && value == std::floor(value), "whole, from 1");
    if (key == "axis") require("axis", value <= kAxes, "1, 2 or 3");
    for (const char* positive : {"pitch_mm", "period_mm", "period_s", "time_constant_s", "decay_mm",
                                 "width_rad", "frequency_hz"}) {
      if (key == positive) require(positive, value > 0.0, "above 0");
    }
  }
}

// A time while a recording of one of the channels is made, away from its ends, or open.
double Instant(double share, const std::vector<RecordedTime>& times, bool probes) {
  constexpr double kFirst = 0.1, kLast = 0.9;
  double total = 0.0;
  for (const RecordedTime& time : times) {
    if (probes ? time.probes : time.linkage) total += time.duration;
  }
  double left = share * total;
  for (const RecordedTime& time : times) {
    if (!(probes ? time.probes : time.linkage)) continue;
    if (left <= time.duration) {
      return time.begin + kFirst * time.duration + (kLast - kFirst) * left;
    }
    left -= time.duration;
  }
  return kOpen;
}

}  // namespace

double HiddenEffect::At(const std::string& key) const {
  return values.at(key) * settings::UnitOf(key).si;
}

HiddenEffect ParseHidden(std::string_view text, std::uint64_t seed, const Sensors& sensors) {
  const std::vector<std::string> parts = Split(text);
  Given given(text, parts);
  const std::string object = given.Take("object");
  const Effect& entry = EntryOf(parts.front(), object, given);
  // Its own stream: the draws of one effect do not depend on the others.
  std::uint64_t stream = kHiddenStream;
  for (const char letter : parts.front() + ":" + object) {
    stream = stream * 131 + static_cast<unsigned char>(letter);
  }
  HiddenEffect effect{&entry, object, Objects().at(object).places, {}, {}, {}, {seed, stream}};
  std::vector<std::string> known = {"object"};
  std::uint64_t index = 0;
  for (const KeyEntry& key : entry.keys) {
    const std::string name(key.name);
    const std::string value = given.Take(name);
    effect.values[name] =
        value.empty() ? Drawn(key, effect.random, index) : given.Number(name, value);
    known.push_back(name);
    ++index;
  }
  if (entry.sensor) {
    const bool link = entry.objects == kLinkObject;
    std::vector<std::string> columns = sensors.columns;
    if (link)
      columns = sensors.links.empty() ? std::vector<std::string>{} : std::vector{sensors.links};
    effect.sensor = SensorOf(given, columns);
    known.emplace_back("sensor");
  }
  given.RefuseRest(known);
  Check(effect, given);
  return effect;
}

void SetInTime(HiddenEffects& hidden, const std::vector<RecordedTime>& times,
               const std::vector<double>& turns) {
  constexpr double kNear = 0.05;  // rad
  for (HiddenEffect& effect : hidden) {
    const bool probes =
        (effect.entry->objects & kProbeObject) != 0 && effect.object.starts_with("probe_");
    const random::CounterRandom& random = effect.random;
    if (!effect.entry->instants.empty() && effect.instants.empty()) {
      const auto count =
          static_cast<std::uint64_t>(effect.values.at(std::string(effect.entry->instants)));
      for (std::uint64_t i = 0; i < count; ++i) {
        effect.instants.push_back(Instant(random.Uniform(kDrawsOfInstants + i), times, probes));
      }
      std::sort(effect.instants.begin(), effect.instants.end());
    }
    for (const KeyEntry& key : effect.entry->keys) {
      double& value = effect.values.at(std::string(key.name));
      if (!std::isnan(value)) continue;
      if (key.draw == Draw::kInstant && key.name == "to_s") {
        // For a tenth to a half of the recordings' mean length.
        double sum = 0.0;
        for (const RecordedTime& time : times) sum += time.duration;
        value = effect.values.at("from_s") + random.Uniform(kDrawsOfInstants + 1, 0.1, 0.5) * sum /
                                                 std::max<std::size_t>(1, times.size());
      } else if (key.draw == Draw::kInstant) {
        value = Instant(random.Uniform(kDrawsOfInstants), times, probes);
      } else if (key.draw == Draw::kTurn && !turns.empty()) {
        value = turns[effect.place()] + random.Uniform(kDrawsOfInstants, -kNear, kNear);
      }
    }
  }
}

nlohmann::ordered_json TruthOf(const HiddenEffects& hidden) {
  nlohmann::ordered_json truth = nlohmann::ordered_json::array();
  for (const HiddenEffect& effect : hidden) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
    for (const KeyEntry& key : effect.entry->keys) {
      parameters[std::string(key.name)] = effect.values.at(std::string(key.name));
    }
    if (!effect.sensor.empty()) parameters["sensor"] = effect.sensor;
    nlohmann::ordered_json one = {{"cause", effect.entry->name},
                                  {"object", effect.object},
                                  {"parameters", std::move(parameters)}};
    if (effect.entry->variable != nullptr) one["variable"] = effect.entry->variable(effect);
    truth.push_back(std::move(one));
  }
  return truth;
}

}  // namespace abbe::rig
