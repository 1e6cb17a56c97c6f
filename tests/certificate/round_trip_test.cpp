// DCC and QIF written and read: the same to the last bit, over random maps and texts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "certificate/certificate_of_map.h"
#include "certificate/dcc.h"
#include "certificate/qif.h"
#include "failure/failure.h"
#include "map/map_cases.h"

namespace abbe::certificate {
namespace round_trip_test {

constexpr int kSeeds = 8;

// One number after the other.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed, 77) {}
  double Uniform() { return random_.Uniform(index_++); }

 private:
  random::CounterRandom random_;
  std::uint64_t index_ = 0;
};

// A text of letters that XML, lists and Unicode make difficult.
std::string RandomText(Draw& draw) {
  constexpr std::array<const char*, 12> kPieces{"a",   "<",   "&", ">", "\"", "'",
                                                "]]>", "%20", "%", "ü", "µ",  "a b"};
  std::string text = "x";
  for (int i = 0; i < 6; ++i) {
    text += kPieces[static_cast<std::size_t>(kPieces.size() * draw.Uniform())];
  }
  return text + "z";
}

// A number of any size, of the smallest and of the largest too.
double RandomNumber(Draw& draw) {
  const double exponent = -320.0 + 620.0 * draw.Uniform();
  return (draw.Uniform() - 0.5) * std::pow(10.0, exponent);
}

Organization RandomOrganization(Draw& draw) {
  const bool full = draw.Uniform() < 0.5;
  return {RandomText(draw), "",   full ? RandomText(draw) : "", full ? "70173" : "",
          RandomText(draw), "DE", full ? RandomText(draw) : "", full ? RandomText(draw) : ""};
}

Certificate RandomCertificate(std::uint64_t seed, Sense sense) {
  Draw draw(seed);
  machine::Chain chain = machine::Chain::Parse(map::kColumn);
  const map::ErrorMap carriages = map::RandomMap(seed);
  chain.ReadPositive("tool tool tool", "");
  machine::VolumetricModel model(chain, carriages.model().travels());
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& function = carriages.model().Function(axis, motion);
      model.SetForm(axis, motion, function.form());
      model.SetCoefficients(axis, motion, function.coefficients());
    }
  }
  model.SetSquareness(carriages.model().squareness());
  Certificate made = CertificateOfMap({carriages.origin(), model, carriages.cov_pp()}, 7, sense);
  Administration& data = made.administration;
  data.number = RandomText(draw);
  data.begin = "2026-11-20";
  data.end = "2026-11-21";
  data.issued = draw.Uniform() < 0.5 ? "2026-11-22" : "";
  data.location = "customer";
  data.decision_rule = draw.Uniform() < 0.5 ? kIso14253 : "none";
  data.laboratory = RandomOrganization(draw);
  data.laboratory.code = RandomText(draw);
  data.customer = RandomOrganization(draw);
  data.people = {{RandomText(draw), RandomText(draw), true}, {RandomText(draw), "", false}};
  data.item = {RandomText(draw), RandomText(draw), "", RandomText(draw)};
  data.instruments = {{RandomText(draw), "", "", RandomText(draw), "", "", ""},
                      {RandomText(draw), RandomText(draw), RandomText(draw), RandomText(draw),
                       RandomText(draw), RandomText(draw), ""},
                      {RandomText(draw), "", "", RandomText(draw), RandomText(draw),
                       RandomText(draw), std::string(64, 'a')}};
  data.conditions = {{RandomText(draw), RandomText(draw)}};
  made.release = "0.1.0";
  made.remarks.push_back(RandomText(draw));
  made.doubts = {RandomText(draw)};
  for (Series& series : made.results) {
    for (double& value : series.values) value = RandomNumber(draw);
    for (double& U95 : series.U95) U95 = std::abs(RandomNumber(draw));
  }
  for (Joint& joint : made.joint) {
    for (double& value : joint.values) value = RandomNumber(draw);
  }
  if (sense == Sense::kTool) return made;
  made.results.push_back(
      {"holes", RandomText(draw), "m", {"a b", "50%", "%20"}, {}, {1, 2, 3}, {}});
  made.conformities = {{RandomText(draw), "um", "pass", RandomNumber(draw), 1.25, 5.0},
                       {RandomText(draw), "urad", "conditionalFail", 5.0, 0.1, 4.9999999999999991}};
  return made;
}

void ExpectSameBits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
}

TEST(Dcc, WrittenAndReadItIsTheSameToTheLastBit) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Certificate made = RandomCertificate(seed, Sense::kCarriages);
    const std::string text = DccText(made);
    const Certificate read = ReadDcc(text, "certificate.xml");
    EXPECT_TRUE(read == made) << "seed " << seed;
    for (std::size_t i = 0; i < made.results.size(); ++i) {
      ExpectSameBits(read.results[i].values, made.results[i].values);
    }
    ExpectSameBits(read.joint.at(0).covariance, made.joint.at(0).covariance);
    EXPECT_EQ(DccText(read), text);
  }
}

TEST(Qif, WrittenAndReadItIsTheSameToTheLastBit) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Certificate made = RandomCertificate(seed, Sense::kTool);
    const Certificate kept = KeptByQif(made), read = ReadQif(QifText(made), "machine.qif");
    EXPECT_TRUE(read == kept) << "seed " << seed;
    for (std::size_t i = 0; i < kept.results.size(); ++i) {
      ExpectSameBits(read.results[i].values, kept.results[i].values);
      ExpectSameBits(read.results[i].U95, kept.results[i].U95);
    }
  }
}

// A squareness of X and Z: B0Z > 0 turns the line of Z towards +x, which makes the angle smaller.
TEST(Qif, ASquarenessIsPositiveWhereTheAngleIsGreaterThanARightOne) {
  Certificate made = RandomCertificate(1, Sense::kTool);
  for (Series& each : made.results) {
    if (each.positions.empty()) each.values = {25e-6};
  }
  const std::string text = QifText(made);
  EXPECT_NE(text.find("<XYSquareness>2.5e-05<"), std::string::npos);
  EXPECT_NE(text.find("<XZSquareness>-2.5e-05<"), std::string::npos);
  EXPECT_NE(text.find("<YZSquareness>2.5e-05<"), std::string::npos);
}

// On a table that carries the workpiece, the turn about Z moves the tool in Y by the way of X: where
// nothing but the turn is uncertain, u(EYX) of the tool is X times that of the turn.
TEST(Qif, UncertaintyOfTheToolContainsTheTurnsOfTheCarriage) {
  const map::ErrorMap carriages = map::RandomMap(3);
  machine::Chain chain = machine::Chain::Parse(map::kColumn);
  chain.ReadPositive("tool tool tool", "");
  machine::VolumetricModel model(chain, carriages.model().travels());
  const auto& turn = carriages.model().Function(0, 5);
  model.SetForm(0, 5, turn.form());
  const Eigen::Index size = model.ParameterCount();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  covariance.topLeftCorner(size - 3, size - 3).diagonal().setConstant(1e-12);
  const Certificate made = CertificateOfMap({{}, model, covariance}, 9, Sense::kTool);
  const Series &EYX = made.results[1], &ECX = made.results[5];
  EXPECT_EQ(EYX.name + ECX.name, "EYXECX");
  EXPECT_GT(ECX.U95.back(), 1e-7);
  for (std::size_t i = 0; i < EYX.values.size(); ++i) {
    // The turn is 1 urad at most here: the second order is 1e-6 of the first.
    EXPECT_NEAR(EYX.U95[i], EYX.positions[i] * ECX.U95[i], 1e-5 * EYX.U95[i] + 1e-18);
  }
}

TEST(Qif, RefusesAnAxisThatCountsAgainstTheTool) {
  const std::string message =
      map::MessageOf<InputError>([] { CertificateOfMap(map::RandomMap(1), 7, Sense::kTool); });
  map::ExpectHas(message, "axis X counts against the tool");
  map::ExpectHas(message, "--format dcc");
}

TEST(Dcc, RefusesWhatIsNoCertificate) {
  const auto refused = [](const std::string& text) {
    return map::MessageOf<InputError>([&] { ReadDcc(text, "c.xml"); });
  };
  map::ExpectHas(refused("nothing"), "c.xml:1: is not XML");
  map::ExpectHas(refused("<a/>"), "is no DCC; its first element is <a>");
  map::ExpectHas(refused("<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>"), "has a DOCTYPE");
  map::ExpectHas(refused(R"(<digitalCalibrationCertificate xmlns="https://ptb.de/dcc"/>)"),
                 "lacks <dcc:administrativeData>");
  const std::string text = DccText(RandomCertificate(2, Sense::kCarriages));
  map::ExpectHas(refused(text.substr(0, text.size() / 2)), "is not XML");
  std::string other = text;
  other.replace(other.find("\\metre"), 6, "\\mile0");
  map::ExpectHas(refused(other), "the unit \\mile0 is none that abbe writes");
}

TEST(Certificate, NeedsAnUncertainty) {
  const map::ErrorMap map = map::RandomMap(1);
  map::ExpectHas(map::MessageOf<InputError>([&] {
                   CertificateOfMap({map.origin(), map.model(), {}}, 7, Sense::kCarriages);
                 }),
                 "states no uncertainty");
}

}  // namespace round_trip_test
}  // namespace abbe::certificate
