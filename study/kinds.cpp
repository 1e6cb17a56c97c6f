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

const StudyKind& StudyNamed(std::string_view name) {
  const auto& kinds = StudyKinds();
  const auto at = std::ranges::find(kinds, name, &StudyKind::name);
  if (at != kinds.end()) return *at;
  std::vector<std::string> names;
  for (const StudyKind& kind : kinds) names.emplace_back(kind.name);
  throw InputError(fmt::format("{}: there is no such study; did you mean {}?", name,
                               settings::NearestWord(std::string(name), names)));
}

}  // namespace abbe::study
