// What `abbe --version` prints: version, compiler, options of the build.
#pragma once

#include <string>

namespace abbe::apps {

std::string BuildFacts();

}  // namespace abbe::apps
