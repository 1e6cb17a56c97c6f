// ISO 230-2 figures of twelve real tests, against an independent computation: NumPy 1.24.2 on the
// data set's flat file all_iso230.csv, which was made from the tables by other means, with
//
//   import csv, collections, numpy as np
//   x = collections.defaultdict(dict)
//   for r in csv.DictReader(open('all_iso230.csv')):
//       x[r['file']][r['direction'], int(r['pos_index']), int(r['cycle'])] = (
//           1e3 * (float(r['reference_mm']) - float(r['target_mm'])))
//   for file, d in x.items():
//       m, n = max(k[1] for k in d), max(k[2] for k in d)
//       u, b = (np.array([[d[s, i + 1, j + 1] for j in range(n)] for i in range(m)])
//               for s in ('fwd', 'bwd'))
//       p, q, s, t = u.mean(1), b.mean(1), 2 * u.std(1, ddof=1), 2 * b.std(1, ddof=1)
//       e = np.r_[p, q]
//       print(file, *('%.3f' % v for v in (
//           np.r_[p + s, q + t].max() - np.r_[p - s, q - t].min(),
//           np.max([s + t + abs(p - q), 2 * s, 2 * t]), np.ptp(e), np.ptp((p + q) / 2),
//           abs(p - q).max(), (p - q).mean())))
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <string>

#include "../folders.h"
#include "apps/reduce_reference.h"
#include "recording/target_table.h"

namespace abbe::apps {
namespace reduce_reference_field_test {

struct Computed {
  const char* file;
  const char* axis;
  double A, R, E, M, B, mean_reversal;  // um
};

void PrintTo(const Computed& computed, std::ostream* out) { *out << computed.file; }

class PositioningField : public testing::TestWithParam<Computed> {};

TEST_P(PositioningField, AgreesWithNumPy) {
  const Computed& numpy = GetParam();
  const auto path = FieldData() / "ess-target-iso230" / (std::string(numpy.file) + ".dat");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: field data not found";
  const auto result = ReduceReference(recording::ReadTargetTable(path, numpy.axis));
  const auto& figures = result["iso230_2"];
  const double kRounded = 0.0005001;  // to a nanometre, above
  EXPECT_NEAR(figures["A_um"], numpy.A, kRounded);
  EXPECT_NEAR(figures["R_um"], numpy.R, kRounded);
  EXPECT_NEAR(figures["E_um"], numpy.E, kRounded);
  EXPECT_NEAR(figures["M_um"], numpy.M, kRounded);
  EXPECT_NEAR(figures["B_um"], numpy.B, kRounded);
  EXPECT_NEAR(figures["mean_reversal_um"], numpy.mean_reversal, kRounded);
}

// The data set itself states, in whole um: b02 x A 135, M 94, mean reversal -25; b02 y A 126; b02 z
// A 37; slit axis A 22. So does the table.
INSTANTIATE_TEST_SUITE_P(
    RealAxes, PositioningField,
    testing::Values(
        Computed{"b02_target_x", "X", 135.271, 55.161, 122.847, 93.653, 33.576, -25.368},
        Computed{"b02_target_y", "Y", 125.717, 46.866, 100.053, 84.265, 20.020, -12.768},
        Computed{"b02_z", "Z", 36.853, 6.418, 35.279, 33.364, 2.364, -1.614},
        Computed{"muts_w42_back_target_x", "X", 273.459, 273.459, 67.223, 33.680, 54.677, -39.540},
        Computed{"muts_w42_back_target_x_2", "X", 303.142, 291.539, 47.730, 22.399, 35.914, -8.632},
        Computed{"muts_w42_back_target_x_8A", "X", 243.375, 237.149, 63.542, 22.260, 51.236,
                 -35.445},
        Computed{"muts_w42_back_target_y", "Y", 167.701, 155.985, 118.370, 25.059, 105.633,
                 -54.906},
        Computed{"muts_w42_back_target_z", "Z", 759.726, 759.726, 48.521, 18.702, 48.521, 29.530},
        Computed{"muts_w42_target_x_ILD50", "X", 201.142, 201.142, 57.031, 26.756, 35.049, -0.734},
        Computed{"muts_w42_target_y_ILD50", "Y", 96.682, 94.327, 26.483, 9.681, 18.592, -10.553},
        Computed{"muts_w42_target_z_ILD2300_below", "Z", 63.114, 50.888, 41.122, 19.915, 31.759,
                 5.644},
        Computed{"slit11360_axis1", "X", 21.969, 14.336, 12.940, 9.242, 4.485, -0.367}));

}  // namespace reduce_reference_field_test
}  // namespace abbe::apps
