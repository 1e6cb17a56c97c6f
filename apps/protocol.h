// The operator and the serial numbers of a measurement, for the title of a report.
//
//   [protocol]                     # in the machine file and in the header of a recording
//   operator = "A. Smith"
//   serial = "mill 4711, head P-12"
//
// A recorder copies the table of the machine file into the header, with the operator of its command
// line; a result copies it from the header. Both keys are optional.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "recording/recording.h"
#include "settings/document.h"

namespace abbe::apps {

struct Protocol {
  std::string operator_name, serial;  // empty: not stated
};

// InputError with file, line and key for a value that is not a text.
Protocol ReadProtocol(const settings::Table& root);

// The table as TOML; a non-empty `operator_name` replaces that of the file. Empty if nothing is
// stated.
std::string ProtocolText(const settings::Document& machine, const std::string& operator_name);

// Adds the table of the header as result["protocol"], and result["simulated"] = true where no
// machine was measured; existing entries of the table are kept.
void AddProtocol(const recording::Recording& recording, nlohmann::ordered_json& result);

}  // namespace abbe::apps
