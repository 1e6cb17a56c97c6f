// What a table states in the name of a column.
//
//   settings::ColumnNameOf("length [mm]");  // {"length", mm}
//
// Units: none. Failure: none; a unit that is not known is part of the quantity.
#pragma once

#include <string_view>

#include "settings/unit.h"

namespace abbe::settings {

struct ColumnName {
  std::string_view quantity;
  Unit unit;  // a plain number without one
};

// Reads "length [mm]", "length (mm)", "length / mm" and "length_mm".
ColumnName ColumnNameOf(std::string_view name);

}  // namespace abbe::settings
