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

// scipy.stats 1.10: 2 t.sf(2.5, 7.3), 2 norm.sf(1.3), t.ppf(0.975, 4.5).
TEST(StudentTwoSided, IsThatOfSciPy) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(StudentTwoSided(2.5, 7.3), 0.039650234665600415, 1e-12);
  EXPECT_NEAR(StudentTwoSided(-2.5, 7.3), 0.039650234665600415, 1e-12);
  EXPECT_NEAR(StudentTwoSided(1.3, kInfinite), 0.19360096917122072, 1e-12);
  EXPECT_EQ(StudentTwoSided(0.0, 3.0), 1.0);
}

// scipy.stats 1.10: t.ppf(0.999, 5.5), norm.ppf(0.999).
TEST(StudentQuantile, IsThatOfSciPy) {
  EXPECT_NEAR(StudentQuantile(0.999, 5.5), 5.504714867564669, 1e-9);
  EXPECT_NEAR(StudentQuantile(0.999, std::numeric_limits<double>::infinity()), 3.090232306167813,
              1e-12);
}

TEST(DegreesOfFreedomOf, UndoesTheCoverage) {
  EXPECT_NEAR(DegreesOfFreedomOf(2.6589123472044034), 4.5, 1e-6);
  for (const double dof : {1.0, 2.0, 7.0, 40.0}) {
    EXPECT_NEAR(DegreesOfFreedomOf(StudentCoverage(dof)), dof, 1e-6 * dof);
  }
  EXPECT_TRUE(std::isinf(DegreesOfFreedomOf(2.0)));
}

}  // namespace student_coverage_test
}  // namespace abbe::standards
