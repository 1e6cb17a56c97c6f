// The limits of a machine, from the table [limits] of its file.
//
//   [limits]
//   circularity_um = 5.0                  # of every plane
//   volumetric_um = 25.0
//   EYX = { straightness_um = 3.0 }       # of one error
//   C0Y = { urad = 30.0 }
//   X = { positioning_A_um = 6.0, positioning_A_u95_um = 0.8 }
//
// A limit is the largest permissible size of a figure; of one with a sign, of its amount. A key
// with _u95 before its unit states the expanded uncertainty of a figure whose result states none.
//
// Units: that of the key. Failure: InputError with file and line for an unknown key, an object that
// does not exist or lies on an axis that the machine does not have, with the nearest name.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::history {

struct Limit {
  std::string object;  // empty: of every object that has the quantity
  std::string quantity;
  double size = 0.0;        // > 0
  double stated_u95 = 0.0;  // 0: that of the result alone

  std::string Name() const { return object.empty() ? quantity : object + "." + quantity; }
};

using Limits = std::vector<Limit>;

struct TravelOfAxis {
  double first_mm = 0.0, last_mm = 0.0;
};
using Travels = std::map<char, TravelOfAxis>;  // by axis

// Those of the machine file.
Travels ReadTravels(const settings::Table& root);

// In the order of the file's keys by kind. Requests all keys of the table, none but these.
Limits ReadLimits(const settings::Table& root);

}  // namespace abbe::history
