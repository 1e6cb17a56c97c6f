#include "history/conformity.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe::history {
namespace {

Judged JudgeOne(const Figure& figure, const Limit& limit) {
  Judged judged{limit, Verdict::kUndecided, figure.object, figure.conditions, figure.value};
  if (figure.u) {
    judged.U95 = figure.U95();
  } else if (limit.stated_u95 > 0.0) {
    judged.U95 = limit.stated_u95;
    judged.u_from_limit = true;
  }
  if (!judged.U95) return judged;
  const double size = std::abs(figure.value);
  if (size + *judged.U95 <= limit.size) judged.verdict = Verdict::kPass;
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

std::vector<Judged> Judge(const std::vector<Figure>& figures, const Limits& limits) {
  std::vector<Judged> all;
  for (const Limit& limit : limits) {
    const std::size_t before = all.size();
    for (const Figure& figure : figures) {
      if (LimitOf(figure.object, figure.quantity, limits) == &limit) {
        all.push_back(JudgeOne(figure, limit));
      }
    }
    if (all.size() == before) all.push_back({limit, Verdict::kNotMeasured, limit.object, "", 0.0});
  }
  return all;
}

}  // namespace abbe::history
