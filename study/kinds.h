// The studies, one line each.
#pragma once

#include <string_view>
#include <vector>

#include "study/study.h"

namespace abbe::study {

const std::vector<StudyKind>& StudyKinds();

// InputError with the nearest name.
const StudyKind& StudyNamed(std::string_view name);

}  // namespace abbe::study
