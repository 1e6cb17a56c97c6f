// Poses of a linkage that repeat.
#include "simulation/linkage/linkage_run.h"

#include <gtest/gtest.h>

#include "../folders.h"
#include "settings/document.h"

namespace abbe::simulation {
namespace linkage_run_test {

// One pose three times, then another.
recording::Recording Repeats(const std::string& header) {
  recording::Recording recording;
  recording.name = "poses.csv";
  recording.header = "kind = \"linkage\"\n" + header;
  recording.columns = {
      {"time_s", {0.0, 1.0, 2.0, 3.0}},       {"ref_x_mm", {30.0, 30.0002, 30.0001, 50.0}},
      {"ref_y_mm", {30.0, 30.0, 30.0, 30.0}}, {"ref_z_mm", {30.0, 30.0, 30.0, 30.0}},
      {"pivot_1_rad", {0.1, 0.1, 0.1, 0.2}},  {"pivot_2_rad", {0.3, 0.3, 0.3, 0.3}},
      {"pivot_3_rad", {0.5, 0.5, 0.5, 0.5}},  {"temp_linkage_c", {20.0, 20.0, 20.0, 20.0}},
      {"flags", {0.0, 0.0, 0.0, 0.0}}};
  return recording;
}

Eigen::Index PosesOf(const std::string& header) {
  const auto demo = settings::Document::Read(DemoMillFile());
  const auto settings = relm::ReadLinkageSettings(demo.Root());
  return MeansOfStays(ReadLinkageRun(Repeats(header), settings)).poses();
}

TEST(LinkageRun, TheRowsOfATableArePosesOfTheirOwn) {
  EXPECT_EQ(PosesOf("time = \"order\"\n"), 4);  // however well a robot repeats
  EXPECT_EQ(PosesOf(""), 2);                    // one stay of a machine
}

}  // namespace linkage_run_test
}  // namespace abbe::simulation
