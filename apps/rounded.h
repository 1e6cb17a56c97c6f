// Numbers with their uncertainty, both rounded to two significant digits of U.
//
//   const Decimals decimals(U);                         // U = 0.1234
//   decimals(31.41593);                                 // "31.42"
//   PlusMinus(31.41593, 0.1234);                        // "31.42 +- 0.12"
//
// Any unit, the same for value and U. A U of 10 or more gives whole numbers; without a U (0, not
// finite) `fallback` decimals are used. Source: JCGM 100:2008, 7.2.6.
#pragma once

#include <string>

namespace abbe::apps {

class Decimals {
 public:
  explicit Decimals(double U, int fallback = 3);

  std::string operator()(double value) const;
  int count() const { return count_; }

 private:
  int count_;
};

std::string PlusMinus(double value, double U);

}  // namespace abbe::apps
