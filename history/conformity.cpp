#include "history/conformity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe::history {
namespace {

// What of the axis the figure does not cover; empty where it covers all.
std::string LeftOut(const Figure& figure, const Travels& travels) {
  constexpr double kEnds = 0.1;  // of the travel: approach and overrun
  if (!figure.stations) return "";
  const Stations& stations = *figure.stations;
  if (stations.missing > 0) {
    return fmt::format("{} of {} planned stations are missing", stations.missing, stations.planned);
  }
  const auto found = travels.find(stations.axis);
  if (found == travels.end()) return "";
  const TravelOfAxis& travel = found->second;
  const double covered =
      std::min(stations.last_mm, travel.last_mm) - std::max(stations.first_mm, travel.first_mm);
  if (covered >= (1.0 - kEnds) * (travel.last_mm - travel.first_mm)) return "";
  return fmt::format(
      "the stations, {:.6g} to {:.6g} mm, leave out part of the travel, {:g} to {:g} mm",
      stations.first_mm, stations.last_mm, travel.first_mm, travel.last_mm);
}

Judged JudgeOne(const Figure& figure, const Limit& limit, const Travels& travels) {
  Judged judged{limit, Verdict::kUndecided, figure.object, figure.conditions, figure.value};
  if (figure.u) {
    judged.U95 = figure.U95();
  } else if (limit.stated_u95 > 0.0) {
    judged.U95 = limit.stated_u95;
    judged.u_from_limit = true;
  }
  if (!judged.U95) {
    judged.reason = "the result states no uncertainty";
    return judged;
  }
  const double size = std::abs(figure.value);
  if (size + *judged.U95 <= limit.size) {
    judged.reason = LeftOut(figure, travels);
    if (judged.reason.empty()) judged.verdict = Verdict::kPass;
  }
  if (size - *judged.U95 > limit.size) judged.verdict = Verdict::kFail;
  return judged;
}

}  // namespace

std::string_view Name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> kNames{"pass", "fail", "undecided", "not measured"};
  return kNames[static_cast<std::size_t>(verdict)];
}

const Limit* LimitOf(const std::string& object, const std::string& quantity, const Limits& limits) {
  const Limit* found = nullptr;
  for (const Limit& each : limits) {
    if (each.quantity != quantity) continue;
    if (each.object == object) return &each;
    if (each.object.empty()) found = &each;
  }
  return found;
}

std::vector<Judged> Judge(const std::vector<Figure>& figures, const Limits& limits,
                          const Travels& travels) {
  std::vector<Judged> all;
  for (const Limit& limit : limits) {
    const std::size_t before = all.size();
    for (const Figure& figure : figures) {
      if (LimitOf(figure.object, figure.quantity, limits) == &limit) {
        all.push_back(JudgeOne(figure, limit, travels));
      }
    }
    if (all.size() == before) all.push_back({limit, Verdict::kNotMeasured, limit.object, "", 0.0});
  }
  return all;
}

}  // namespace abbe::history
