// The option --model of the commands that evaluate the linkage.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "relm/linkage_settings.h"

namespace abbe::apps {

inline CLI::Option* AddErrorModelOption(CLI::App& command, relm::ErrorModel& model) {
  using relm::ErrorModel;
  const std::map<std::string, ErrorModel> models{
      {"pivots", ErrorModel::kPivots},
      {"published", ErrorModel::kPublished},
      {"published-with-bearing", ErrorModel::kPublishedWithBearing},
      {"complete", ErrorModel::kComplete}};
  return command
      .add_option("--model", model,
                  "Error model: pivots, published, published-with-bearing or complete")
      ->option_text("NAME [complete]")
      ->transform(CLI::CheckedTransformer(models));
}

}  // namespace abbe::apps
