#include "study/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "failure/failure.h"
#include "settings/nearest_word.h"
#include "study/circle/circle_study.h"
#include "study/head/head_study.h"
#include "study/hidden/hidden_study.h"

namespace abbe::study {

const std::vector<StudyKind>& StudyKinds() {
  static const std::vector<StudyKind> kinds{kHeadStudy, kHiddenStudy, kCircleStudy};
  return kinds;
}

std::vector<double> NumbersOf(const Row& row, const char* key, std::size_t count) {
  auto numbers = row.at(key).get<std::vector<double>>();
  if (numbers.size() == count) return numbers;
  throw InputError(fmt::format("a row has {} numbers of \"{}\", not {}; make the store anew",
                               numbers.size(), key, count));
}

Rate RateOf(const Row& row, const char* worlds, const char* met) {
  const Row &all = row.at(worlds), &some = row.at(met);
  constexpr int kMost = 1'000'000'000;
  // A count is signed in a row that was just made, unsigned in one that was read.
  if (!all.is_number_integer() || !some.is_number_integer() || all > kMost || some > all ||
      some < 0) {
    throw InputError(
        fmt::format("a row has no rate of \"{}\" among \"{}\"; make the store anew", met, worlds));
  }
  return {all.get<int>(), some.get<int>()};
}

const StudyKind& StudyNamed(std::string_view name) {
  const auto& kinds = StudyKinds();
  const auto at = std::ranges::find(kinds, name, &StudyKind::name);
  if (at != kinds.end()) return *at;
  std::vector<std::string> names;
  names.reserve(kinds.size());
  for (const StudyKind& kind : kinds) names.emplace_back(kind.name);
  throw InputError(fmt::format("{}: there is no such study; did you mean {}?", name,
                               settings::NearestWord(std::string(name), names)));
}

}  // namespace abbe::study
