// The two tables of 16-bit registers that a Modbus device has.
#pragma once

namespace abbe::hal {

enum class RegisterTable { kHolding, kInput };  // function codes 3 and 4

}  // namespace abbe::hal
