// abbe sensitivity for the linkage.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "relm/linkage_sensitivity.h"

namespace abbe::apps {

struct LinkageSensitivityOptions {
  std::filesystem::path machine;
  std::optional<relm::ErrorModel> model;  // complete
  std::vector<double> size_mm{25, 25, 50};
  std::vector<double> centre_mm{0, 0, 0};
  int points = 3;
  double warmth_c = 0;
  relm::SensitivityOptions run;
  std::filesystem::path json;
};

int RunLinkageSensitivity(const LinkageSensitivityOptions& options);

}  // namespace abbe::apps
