#include "standards/student_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abbe::standards {
namespace student_coverage_test {

// GUM (JCGM 100:2008), table G.2, column 95 %.
TEST(StudentCoverage, IsThatOfTheGum) {
  const double table[][2] = {{1, 12.71}, {2, 4.30}, {3, 3.18}, {10, 2.23}, {50, 2.01}};
  for (const auto& [dof, t] : table) EXPECT_NEAR(StudentCoverage(dof), t, 0.005) << dof;
  EXPECT_NEAR(StudentCoverage(std::numeric_limits<double>::infinity()), 1.960, 0.0005);
  EXPECT_TRUE(std::isinf(StudentCoverage(0.0)));
}

}  // namespace student_coverage_test
}  // namespace abbe::standards
