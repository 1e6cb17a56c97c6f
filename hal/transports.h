// Every transport. To add one, see transport.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hal/transport.h"

namespace abbe::hal {

// The first is that of a table without the key `transport`.
const std::vector<Transport>& Transports();

// Tables [devices] of a machine file, to be filled in: a probe amplifier and a control with a scale
// for each letter of `axes`.
std::string ExampleDevices(std::string_view axes);

}  // namespace abbe::hal
