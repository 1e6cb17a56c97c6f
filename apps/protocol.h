// Who measured with what: the title of a report has it.
//
//   [protocol]                              # in the machine file, and so in the header of a
//   recording operator = "A. Smith" serial = "mill 4711, head P-12"
//
// A recorder writes the table of the machine file into the header, with the operator of its command
// line; a result takes it from the header. Both keys may be absent: nothing depends on them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "recording/recording.h"
#include "settings/document.h"

namespace abbe::apps {

struct Protocol {
  std::string operator_name, serial;  // empty: not stated
};

// InputError with file, line and key for what is no text.
Protocol ReadProtocol(const settings::Table& root);

// The table, with `operator_name` instead of the file's if there is one; empty where nothing is
// stated.
std::string ProtocolText(const settings::Document& machine, const std::string& operator_name);

// What the header of the recording states, as result["protocol"]; what stands there already stays.
void AddProtocol(const recording::Recording& recording, nlohmann::ordered_json& result);

}  // namespace abbe::apps
