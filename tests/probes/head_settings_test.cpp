#include "probes/head_settings.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <string>

#include "../folders.h"
#include "failure/failure.h"

namespace abbe::probes {
namespace head_settings_test {

HeadSettings Read(const std::string& text) {
  return ReadHeadSettings(settings::Document::Parse(text, "mill.toml").Root());
}

std::string Refusal(const std::string& text) {
  try {
    Read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(HeadSettings, ReadsTheDemonstrationMachine) {
  const auto document = settings::Document::Read(DemoMillFile());
  const HeadSettings head = ReadHeadSettings(document.Root());
  EXPECT_DOUBLE_EQ(head.layout.top[2].s, -10e-3);
  EXPECT_DOUBLE_EQ(head.layout.side[1].n, 20e-3);
  EXPECT_DOUBLE_EQ(head.probes[3].range, 200e-6);
  EXPECT_FALSE(head.probes[3].zero_gap);
  EXPECT_DOUBLE_EQ(head.probes[3].gain, 1);
  EXPECT_DOUBLE_EQ(head.tolerance.installation, 500e-6);
  EXPECT_DOUBLE_EQ(head.tolerance.gain, 500e-6);
  EXPECT_EQ(head.Frame('Y').R_MH.col(1), -Eigen::Vector3d::UnitX());
  EXPECT_DOUBLE_EQ(head.Frame('Z').p_MH.y(), 15e-3);
  EXPECT_DOUBLE_EQ(ReadTargetSettings(document.Root()).u_squareness, 2e-6);
  EXPECT_DOUBLE_EQ(ReadTargetSettings(document.Root()).form, 10e-9);
  EXPECT_DOUBLE_EQ(ReadProbeNoise(document.Root()).probe, 20e-9);
  EXPECT_DOUBLE_EQ(ReadProbeNoise(document.Root()).drift_time, 600);
}

TEST(HeadSettings, AreThoseOfTheSourceWhereTheFileIsSilent) {
  const HeadSettings head = Read("");
  const HeadLayout<> nominal = NominalLayout();
  for (std::size_t i = 0; i < kTopProbes; ++i) {
    EXPECT_DOUBLE_EQ(head.layout.top[i].u, nominal.top[i].u);
    EXPECT_DOUBLE_EQ(head.layout.top[i].s, nominal.top[i].s);
  }
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    EXPECT_DOUBLE_EQ(head.layout.side[i].u, nominal.side[i].u);
    EXPECT_DOUBLE_EQ(head.layout.side[i].n, nominal.side[i].n);
  }
  EXPECT_EQ(head.electrode.radius, 0);
  EXPECT_EQ(head.installation.roll, 0);
  for (const char axis : {'X', 'Y', 'Z'}) {
    EXPECT_EQ(head.Frame(axis).R_MH.determinant(), 1);
    EXPECT_EQ(head.Frame(axis).R_MH.col(0), Eigen::Vector3d::Unit(axis - 'X'));
  }
  EXPECT_THROW(head.Frame('A'), InputError);
}

TEST(HeadSettings, ReadsWhatACalibratedHeadAdds) {
  const HeadSettings head = Read(R"([head]
electrode_radius_mm = 2.5
stray_per_mm = 0.5
[head.probe_b]
position_mm = [0.01, 10.02]
zero_gap_um = 100.0
gain = 1.002
[head.installation]
yaw_urad = 2000.0
dn_um = -50.0
)");
  EXPECT_DOUBLE_EQ(head.electrode.radius, 2.5e-3);
  EXPECT_DOUBLE_EQ(head.electrode.stray, 500);  // 1/m
  EXPECT_DOUBLE_EQ(head.layout.top[1].u, 10e-6);
  EXPECT_DOUBLE_EQ(head.probes[1].zero_gap.value(), 100e-6);
  EXPECT_DOUBLE_EQ(head.probes[1].gain, 1.002);
  EXPECT_DOUBLE_EQ(head.installation.yaw, 2e-3);
  EXPECT_DOUBLE_EQ(head.installation.dn, -50e-6);
}

TEST(HeadSettings, RefuseWithLineAndKey) {
  const auto names = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  names(Refusal("[head.probe_a]\nrnage_um = 3"),
        "mill.toml:2: head.probe_a.rnage_um: is not a known "
        "key; did you mean \"range_um\"?");
  names(Refusal("[head]\nelectrode_mm = 3"), "head.electrode_mm: is not a known key");
  names(Refusal("[head.axis_X]\nrotation = [\"y\", \"-x\", \"z\"]"), "must begin with \"x\"");
  names(Refusal("[head.axis_X]\nrotation = [\"-x\", \"-y\", \"z\"]"), "must begin with \"x\"");
  names(Refusal("[head.axis_X]\nrotation = [\"x\", \"y\", \"-z\"]"),
        "must be a right-handed frame");
  names(Refusal("[head.axis_X]\nrotation = [\"x\", \"x\", \"z\"]"), "must be a right-handed frame");
  names(Refusal("[head.axis_X]\nrotation = [\"x\", \"+y\", \"z\"]"), "is not a machine direction");
  names(Refusal("[head.axis_X]\nrotation = [\"x\", \"\", \"z\"]"), "is not a machine direction");
  names(Refusal("[head.probe_d]\nunit = \"top\""), "head.probe_d.unit: must be \"side\"");
  names(Refusal("[head.probe_d]\nzero_gap_um = 300.0"), "above range_um");
  names(Refusal("[head.tolerance]\ngain_ppm = -1.0"), "at least");
  names(Refusal("[head.probe_c]\nposition_mm = [20.0, -10.0]"), "probe head: the top probes A, B");
  names(Refusal("[head.probe_c]\nposition_mm = [20.0, -10.0]"), "mill.toml:");
}

}  // namespace head_settings_test
}  // namespace abbe::probes
