// Corrected rows and axes against the chain that they write: the same tips for any angles, in their
// own base; and numbers that are known because the chain was made from them.
#include "relm/chain_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "relm/linkage_text.h"
#include "settings/document.h"

namespace abbe::relm {
namespace chain_rows_test {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRounding = 1e-12;  // m, rad: of some thousand operations on an arm of a metre

DenavitHartenbergRow Row(double theta, double d, double a, double alpha, bool fixed = false) {
  return {kDegree * theta, d, a, kDegree * alpha, fixed};
}

// Axes 2 and 3 are parallel; a fixed row stands before and one behind all joints.
WrittenChain Rows() {
  return {{Row(-90, -0.26, 0, 15, true), Row(0, 0.29, 0.1, -90), Row(-90, 0, 0.27, 0),
           Row(0, 0, 0.07, -90), Row(0, 0.302, 0, 90), Row(0, 0, 0, -90), Row(180, 0.072, 0, 0),
           Row(30, 0, 0.01, 40, true)},
          {},
          Vector3d(0.01, -0.003, 0.124)};
}

WrittenChain Axes() { return {{}, Rows().Chain().axes(), Rows().Chain().tip()}; }

// Every line a few mm and mrad off, and the whole chain somewhere else.
SerialChain Moved(const SerialChain& chain, std::uint64_t seed) {
  const random::CounterRandom random(seed, 4);
  std::uint64_t draw = 0;
  const auto triple = [&](double size) -> Vector3d {
    draw += 3;
    return size * Vector3d(random.Normal(draw), random.Normal(draw + 1), random.Normal(draw + 2));
  };
  std::vector<JointAxis> axes = chain.axes();
  const auto whole = Eigen::AngleAxisd(0.05, triple(1.0).normalized());
  for (JointAxis& axis : axes) {
    axis.point = whole * (axis.point + triple(2e-3));
    axis.direction = whole * (axis.direction + triple(3e-3));
  }
  return {axes, whole * (chain.tip() + triple(2e-3))};
}

void ExpectTheSame(const WrittenChain& written, const SerialChain& chain) {
  const auto back = written.X_BW.Inverse();
  const SerialChain read = written.Chain();
  for (const double angle : {0.0, 0.4, -1.3, 2.9}) {
    VectorXd q = VectorXd::LinSpaced(chain.joints(), angle, -0.7 * angle);
    EXPECT_LT((read.Tip(q) - back * chain.Tip(q)).norm(), kRounding) << angle;
  }
}

TEST(ChainRows, WriteTheChainThatWasFound) {
  for (const WrittenChain& nominal : {Rows(), Axes()}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const SerialChain chain = Moved(nominal.Chain(), seed);
      const WrittenChain written = nominal.With(chain);
      ExpectTheSame(written, chain);
      // A second calibration starts from rows with a tilt of their own.
      const SerialChain again = Moved(written.Chain(), seed + 100);
      ExpectTheSame(written.With(again), again);
      EXPECT_EQ(written.With(again).rows.size(), written.rows.size());
    }
  }
}

TEST(ChainRows, ChangeNothingOfTheChainThatTheyAre) {
  for (const WrittenChain& nominal : {Rows(), Axes()}) {
    WrittenChain same = nominal.With(nominal.Chain());
    if (!same.rows.empty()) {
      ASSERT_EQ(same.rows.size(), nominal.rows.size() + 1);  // the tilt between parallel axes
      EXPECT_NEAR(same.rows[3].alpha, 0.0, kRounding);
      EXPECT_NEAR(same.rows[4].theta, nominal.rows[3].theta - std::numbers::pi / 2.0, kRounding);
      same.rows[4].theta = nominal.rows[3].theta;
      same.rows.erase(same.rows.begin() + 3);
    }
    EXPECT_LT((same.Numbers() - nominal.Numbers()).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LT(same.X_BW.p.norm(), kRounding);
  }
}

TEST(ChainRows, FindTheNumbersThatWereChanged) {
  const WrittenChain nominal = Rows().With(Rows().Chain());  // with the tilt's row
  WrittenChain other = nominal;
  other.rows[1].a += 1e-3;     // of the first joint: theta and d are open, a and alpha are not
  other.rows[2].a -= 0.5e-3;   // between the parallel axes
  other.rows[3].alpha = 2e-3;  // their tilt
  other.rows[5].d += 0.7e-3;
  other.rows[5].theta = 1e-3;
  other.rows[6].alpha += 1e-3;
  other.ball.y() += 2e-3;
  const WrittenChain found = nominal.With(other.Chain());
  EXPECT_LT((found.Numbers() - other.Numbers()).cwiseAbs().maxCoeff(), kRounding);
}

TEST(ChainRows, RefuseWhatTheyCannotWrite) {
  WrittenChain between = Rows();
  between.rows.insert(between.rows.begin() + 2, Row(10, 0, 0.1, 5, true));
  EXPECT_THAT([&] { between.With(between.Chain()); },
              testing::ThrowsMessage<InputError>(HasSubstr("row 3")));
  WrittenChain one_line{{Row(0, 0.1, 0, 0), Row(0, 0.2, 0.1, 0)}, {}, Vector3d::Zero()};
  EXPECT_THAT([&] { one_line.With(one_line.Chain()); },
              testing::ThrowsMessage<InputError>(HasSubstr("one line")));
}

constexpr const char* kFile = R"(name = "arm"  # the old one
[linkage]
form = "denavit-hartenberg"
ball_mm = [0.0, 1.0,
           30.0]
[[linkage.joint]]   # shoulder
d_mm = 290
alpha_deg = -90
[[linkage.joint]]
a_mm = 270
[linkage.base]
position_mm = [0, 0, 0]  # anywhere
)";

TEST(ChainRows, AreWrittenIntoTheTextOfTheirFile) {
  const auto read = [](const std::string& text) {
    return ReadLinkageSettings(settings::Document::Parse(text, "arm.toml").Root());
  };
  const LinkageSettings settings = read(kFile);
  WrittenChain written = WrittenChain::Of(settings);
  written.rows[1].a = 0.2705;
  written.ball.x() = 0.25e-3;
  const VectorXd u95 = VectorXd::Constant(written.Numbers().size(), 1e-5);
  const std::string text = WithGeometry(kFile, written, u95, "arm.toml");
  const LinkageSettings again = read(text);
  EXPECT_NEAR(again.rows[1].a, 0.2705, 1e-9);
  EXPECT_NEAR(again.p_nT.x(), 0.25e-3, 1e-9);
  EXPECT_EQ(again.rows[0].d, 0.29);
  EXPECT_THAT(text, HasSubstr("# the old one"));
  EXPECT_THAT(text, HasSubstr("# anywhere"));
  EXPECT_THAT(text, HasSubstr("U95: theta_deg 0.00057, d_mm 0.01"));
  // A second time, its rows are inline.
  EXPECT_EQ(WithGeometry(text, written, u95, "arm.toml"), text);
  EXPECT_THAT([&] { WithGeometry("linkage.form = \"axes\"\n", written, u95, "odd.toml"); },
              testing::ThrowsMessage<InputError>(HasSubstr("odd.toml")));
}

}  // namespace chain_rows_test
}  // namespace abbe::relm
