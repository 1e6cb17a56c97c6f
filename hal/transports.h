// Every transport. To add one, see transport.h.
#pragma once

#include <vector>

#include "hal/transport.h"

namespace abbe::hal {

// The first is that of a table without the key `transport`.
const std::vector<Transport>& Transports();

}  // namespace abbe::hal
