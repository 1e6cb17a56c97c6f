// A stranger's program: reads a length from a table; exits with 0 when it came out in metres.
#include <cmath>

#include "settings/document.h"

int main() {
  const auto document = abbe::settings::Document::Parse("arm_mm = 10.0\n", "consumer");
  return std::abs(document.Root().Quantity("arm_mm") - 0.010) < 1e-15 ? 0 : 1;
}
