#include "simulation/causes/object.h"

#include <charconv>
#include <optional>

namespace abbe::simulation {
namespace {

std::optional<int> Letter(std::string_view text, char first, char last) {
  if (text.size() != 1 || text[0] < first || text[0] > last) return {};
  return text[0] - first;
}

std::optional<int> Axis(std::string_view text) { return Letter(text, 'X', 'Z'); }

// `prefix` and a letter or a number from 1.
std::optional<int> Probe(std::string_view text) {
  constexpr std::string_view kPrefix = "probe_";
  if (!text.starts_with(kPrefix)) return {};
  return Letter(text.substr(kPrefix.size()), 'a', 'e');
}

std::optional<int> Numbered(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return {};
  int number = 0;
  const auto [end, error] =
      std::from_chars(text.data() + prefix.size(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 1) return {};
  return number - 1;
}

}  // namespace

Object::Object(std::string_view name) : name_(name) {
  const std::string_view part = name.substr(0, name.find(' '));
  part_size_ = part.size();
  if (part.size() < name.size()) sensor_ = name.substr(part.size() + 1);
  const auto single = [&](std::optional<int> index, Kind kind) {
    if (!index) return;
    kind_ = kind;
    first_ = *index;
  };
  const auto pair = [&](std::optional<int> first, std::optional<int> second, Kind kind) {
    if (!first || !second) return;
    kind_ = kind;
    first_ = *first;
    second_ = *second;
  };
  single(Axis(part), Kind::kAxis);
  single(Probe(part), Kind::kProbe);
  single(Numbered(part, "pivot_"), Kind::kPivot);
  single(Numbered(part, "link_"), Kind::kLink);
  single(Numbered(part, "sensor_"), Kind::kSensor);
  if (part.size() == 2) pair(Axis(part.substr(0, 1)), Axis(part.substr(1)), Kind::kAxisPair);
  if (const auto plus = part.find('+'); plus != std::string_view::npos) {
    pair(Probe(part.substr(0, plus)), Probe(part.substr(plus + 1)), Kind::kProbePair);
  }
}

std::string Title(const Object& object) {
  return object.sensor().empty() ? object.part() : object.part() + " (" + object.sensor() + ")";
}

}  // namespace abbe::simulation
