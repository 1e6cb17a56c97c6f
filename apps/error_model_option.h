// The option --model of the commands that evaluate the linkage; without it `model` stays empty.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "relm/error_model_name.h"

namespace abbe::apps {

inline CLI::Option* AddErrorModelOption(CLI::App& command, std::optional<relm::ErrorModel>& model) {
  return command
      .add_option_function<std::string>(
          "--model", [&model](const std::string& name) { model = relm::ErrorModelNamed(name); },
          "Error model: " + relm::ErrorModelNames())
      ->option_text("NAME [complete]");
}

}  // namespace abbe::apps
