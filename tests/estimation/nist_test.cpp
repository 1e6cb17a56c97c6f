// Certified regressions: NIST/ITL Statistical Reference Datasets (StRD), nonlinear and linear
// regression, www.itl.nist.gov/div898/strd. Data and certified values are in the public domain. The
// data are checked against the certified residual sum of squares at the certified parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "estimation/autodiff_residual.h"
#include "estimation/problem.h"

namespace abbe::estimation {
namespace nist_test {

// Certified values have 11 digits.
constexpr double kCertified = 1e-10;

struct Dataset {
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> certified, deviation;
  double residual_sum;  // of squares
  int freedom;
};

struct Misra1a {
  template <class T>
  static T Predict(const T* b, double x) {
    return b[0] * (1.0 - exp(-b[1] * x));
  }
  static Dataset Data() {
    return {{77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1,
             689.1, 760.0},
            {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40,
             75.47, 81.78},
            {{500, 1e-4}, {250, 5e-4}},
            {2.3894212918E+02, 5.5015643181E-04},
            {2.7070075241E+00, 7.2668688436E-06},
            1.2455138894E-01,
            12};
  }
};

struct Thurber {
  template <class T>
  static T Predict(const T* b, double x) {
    return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1.0 + x * (b[4] + x * (b[5] + x * b[6])));
  }
  static Dataset Data() {
    return {{-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
             -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
             -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
             0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
            {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,
             92.405,   95.854,   100.696,  101.060,  401.672,  390.724,  567.534,  635.316,
             733.054,  759.087,  894.206,  990.785,  1090.109, 1080.914, 1122.643, 1178.351,
             1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384,
             1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
            {{1000, 1000, 400, 40, 0.7, 0.3, 0.03}, {1300, 1500, 500, 75, 1, 0.4, 0.05}},
            {1.2881396800E+03, 1.4910792535E+03, 5.8323836877E+02, 7.5416644291E+01,
             9.6629502864E-01, 3.9797285797E-01, 4.9727297349E-02},
            {4.6647963344E+00, 3.9571156086E+01, 2.8698696102E+01, 5.5675370270E+00,
             3.1333340687E-02, 1.4984928198E-02, 6.5842344623E-03},
            5.6427082397E+03,
            30};
  }
};

struct Mgh09 {
  template <class T>
  static T Predict(const T* b, double x) {
    return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
  }
  static Dataset Data() {
    return {
        {4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625},
        {0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246},
        {{25, 39, 41.5, 39}, {0.25, 0.39, 0.415, 0.39}},
        {1.9280693458E-01, 1.9128232873E-01, 1.2305650693E-01, 1.3606233068E-01},
        {1.1435312227E-02, 1.9633220911E-01, 8.0842031232E-02, 9.0025542308E-02},
        3.0750560385E-04,
        7};
  }
};

template <class Model>
struct Deviations {
  Dataset data;
  template <class T>
  void operator()(const T* b, T* values) const {
    for (std::size_t i = 0; i < data.x.size(); ++i) {
      values[i] = Model::Predict(b, data.x[i]) - data.y[i];
    }
  }
};

template <class Model>
class Nist : public testing::Test {};
using Models = testing::Types<Misra1a, Thurber, Mgh09>;
TYPED_TEST_SUITE(Nist, Models);

TYPED_TEST(Nist, TheDataAreThoseThatWereCertified) {
  const Dataset data = TypeParam::Data();
  std::vector<double> off(data.x.size());
  Deviations<TypeParam>{data}(data.certified.data(), off.data());
  double sum = 0.0;
  for (const double r : off) sum += r * r;
  EXPECT_NEAR(sum / data.residual_sum, 1.0, kCertified);
}

TYPED_TEST(Nist, GivesTheCertifiedValuesFromBothStarts) {
  const Dataset data = TypeParam::Data();
  const double sigma = std::sqrt(data.residual_sum / data.freedom);
  for (const std::vector<double>& start : data.starts) {
    Problem problem;
    ParameterBlock block{"b", {}, {}};
    for (std::size_t i = 0; i < start.size(); ++i) {
      block.entries.push_back({.name = std::to_string(i + 1), .value = start[i]});
    }
    const BlockId b = problem.Add(block);
    problem.Add(problem.AddSource("data"),
                MakeAutoDiffResidual<4>(Deviations<TypeParam>{data}, data.x.size()), {b}, sigma);
    const Result result = problem.Solve({.max_iterations = 1000});
    ASSERT_TRUE(result.Usable());
    EXPECT_EQ(result.freedom, data.freedom);
    EXPECT_NEAR(result.chi_square / data.freedom, 1.0, kCertified);
    for (std::size_t i = 0; i < start.size(); ++i) {
      const Parameter& entry = result.blocks[0].entries[i];
      // The solve stops 1e-6 standard uncertainties before the minimum at the latest.
      EXPECT_NEAR(entry.value, data.certified[i], 1e-6 * data.deviation[i]) << entry.name;
      // The deviation changes with the parameters: by some 1e-6 within that distance.
      EXPECT_NEAR(entry.uncertainty / data.deviation[i], 1.0, 1e-6) << entry.name;
    }
    EXPECT_TRUE(result.weak_directions.empty());
  }
}

// Linear regression, dataset Longley: columns that are nearly dependent, condition 4e4 scaled to 1.
TEST(NistLinear, GivesTheCertifiedValuesOfLongley) {
  Eigen::Matrix<double, 16, 7> rows;                      // y, x1 to x6
  rows << 60323, 83.0, 234289, 2356, 1590, 107608, 1947,  //
      61122, 88.5, 259426, 2325, 1456, 108632, 1948,      //
      60171, 88.2, 258054, 3682, 1616, 109773, 1949,      //
      61187, 89.5, 284599, 3351, 1650, 110929, 1950,      //
      63221, 96.2, 328975, 2099, 3099, 112075, 1951,      //
      63639, 98.1, 346999, 1932, 3594, 113270, 1952,      //
      64989, 99.0, 365385, 1870, 3547, 115094, 1953,      //
      63761, 100.0, 363112, 3578, 3350, 116219, 1954,     //
      66019, 101.2, 397469, 2904, 3048, 117388, 1955,     //
      67857, 104.6, 419180, 2822, 2857, 118734, 1956,     //
      68169, 108.4, 442769, 2936, 2798, 120445, 1957,     //
      66513, 110.8, 444546, 4681, 2637, 121950, 1958,     //
      68655, 112.6, 482704, 3813, 2552, 123366, 1959,     //
      69564, 114.2, 502601, 3931, 2514, 125368, 1960,     //
      69331, 115.7, 518173, 4806, 2572, 127852, 1961,     //
      70551, 116.9, 554894, 4007, 2827, 130081, 1962;
  const std::vector<double> certified{-3482258.63459582, 15.0618722713733,  -0.0358191792925910,
                                      -2.02022980381683, -1.03322686717359, -0.0511041056535807,
                                      1829.15146461355};
  const std::vector<double> deviation{890420.383607373,  84.9149257747669,  0.0334910077722432,
                                      0.488399681651699, 0.214274163161675, 0.226073200069370,
                                      455.478499142212};
  constexpr double kSigma = 304.854073561965;
  RowMatrix a = rows;
  a.col(0).setOnes();
  Problem problem;
  ParameterBlock block{"b", {}, {}};
  for (std::size_t i = 0; i < certified.size(); ++i) block.entries.push_back({std::to_string(i)});
  const BlockId b = problem.Add(block);
  problem.Add(problem.AddSource("data"),
              std::make_shared<LinearResidual>(std::move(a), Eigen::VectorXd(rows.col(0))), {b},
              kSigma);
  const Result result = problem.Solve();
  ASSERT_TRUE(result.Usable());
  EXPECT_LE(result.iterations, 3);  // no search
  EXPECT_NEAR(result.chi_square / 9.0, 1.0, kCertified);
  for (std::size_t i = 0; i < certified.size(); ++i) {
    const Parameter& entry = result.blocks[0].entries[i];
    EXPECT_NEAR(entry.value, certified[i], 1e-6 * deviation[i]) << i;
    EXPECT_NEAR(entry.uncertainty / deviation[i], 1.0, 1e-6) << i;
  }
}

}  // namespace nist_test
}  // namespace abbe::estimation
