// A machine, a file or a channel may have any name: in the header of every recording that is
// written stand quotes and backslashes as they are, in CSV and in HDF5.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "hal/can/candump_recording.h"
#include "recording/ballbar.h"
#include "recording/csv_table.h"
#include "recording/hole_table.h"
#include "recording/laser_table.h"
#include "recording/monitor_log.h"
#include "recording/recording_file.h"
#include "recording/target_table.h"
#include "rig/probe_runs.h"
#include "rig/record_ballbar.h"
#include "rig/record_course.h"
#include "rig/record_lengths.h"
#include "rig/record_plate.h"
#include "rig/record_sweep.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace quoted_names_test {

namespace fs = std::filesystem;
using recording::Recording;

const std::string kName = R"(a"b\c)";

// What a writer makes, and what its header then says.
struct Written {
  const char* writer;
  std::function<Recording(const fs::path& folder)> make;
  std::map<std::string, std::string> says;
};

fs::path Put(const fs::path& folder, const std::string& extension, const std::string& text) {
  const fs::path path = folder / (kName + extension);
  std::ofstream(path) << text;
  return path;
}

World NamedWorld() {
  RigSettings settings = PerfectRig();
  settings.name = kName;
  return {settings, 1};
}

LinkageRig NamedRig() { return {NamedWorld(), Linkage(ReadLinkage(DemoMill().Root()), 1)}; }

Course ShortCourse() { return CircleCourse({.radius = 2e-3, .feed = 10e-3}); }

Recording OfCsvTable(const fs::path& folder) {
  const fs::path path = Put(folder, ".csv", "b\\c,d\n1,2\n3,4\n");
  return recording::ReadCsvTable(path, {.columns = {{"gap_1_mm", "b\\c"}}, .kind = "dwell"});
}

Recording OfTargetTable(const fs::path& folder) {
  return recording::ReadTargetTable(
      Put(folder, ".dat",
          "CYCLES=2\nPOSITIONS=2\nREF_PV=" + kName + "\nTGT_SET_PV=" + kName +
              "\nTGT_DATA[1]=0\nTGT_DATA[2]=9\nREF_DATA_FWD[1,1]=0\nREF_DATA_FWD[2,1]=9\n"
              "REF_DATA_BWD[1,1]=0\nREF_DATA_BWD[2,1]=9\nREF_DATA_FWD[1,2]=0\n"
              "REF_DATA_FWD[2,2]=9\nREF_DATA_BWD[1,2]=0\nREF_DATA_BWD[2,2]=9\n"));
}

Recording OfLaserTable(const fs::path& folder) {
  return recording::ReadLaserTable(
      Put(folder, ".rtl",
          "HEADER::\nFile type  : rtl\nTARGET DATA::\nTarget-count: 2\nTargets :\n0 100\n"
          "Flags: 0 0 2 0\nUSER-TEXT::\nAxis:X\nRUNS::\nRun-count:2\nDEVIATIONS::\n"
          "Run Target Data:\n1 1 0.5\n1 2 2\n2 2 3\n2 1 1.5\nEOF::\n"),
      "");
}

Recording OfHoleTable(const fs::path& folder) {
  return recording::ReadHoleTable(
      Put(folder, ".txt", "Meas X    Meas Y     Nom X     Nom Y\n1 2 1 2\n3 4 3 4\n"), 1.0);
}

Recording OfMonitorLog(const fs::path& folder) {
  return recording::ReadMonitorLog(
      Put(folder, ".log",
          kName + " 2023-02-08 14:21:15.5 1\n" + kName + " 2023-02-08 14:21:16 2\n"),
      {{"gap_mm", kName}});
}

Recording OfBallbar(const fs::path&) {
  Recording table;
  table.header = "kind = \"linkage\"\n";
  table.columns = {{"angle_deg", {0, 90, 180, 270, 360}}, {"deviation_um", {0, 1, 2, 1, 0}}};
  return recording::BallbarOf(table, {.radius_mm = 150.0, .ballbar = kName});
}

Recording OfCandump(const fs::path&) {
  hal::EncoderSettings encoder;
  encoder.name = "pivot_1_rad";
  encoder.node = 1;
  encoder.bits = 16;
  encoder.counts_per_turn = 65536.0;
  encoder.range = 65536;
  const hal::CanopenSettings device{
      .name = kName, .interface = kName, .times = {}, .encoders = {encoder}};
  hal::CandumpLog log;
  log.name = "a.log";
  for (int i = 0; i < 4; ++i) {
    log.frames.push_back({0.01 * i, kName, {.id = 0x080, .size = 0}});
    log.frames.push_back({0.01 * i + 1e-3, kName, {.id = 0x181, .size = 2}});
  }
  return hal::RecordingOf(log, device, 1.0, kName);
}

ProbeRunOptions ShortRun() {
  ProbeRunOptions options;
  options.rate = 50.0;
  options.stand = 0.05;
  options.places = 2;
  options.length = 1.0;
  return options;
}

std::vector<hal::Channel> Channels() {
  return ChannelsOf(hal::ReadDevices(DemoMill().Root().Child("devices")));
}

std::vector<Written> Writers() {
  return {
      {"csv table", OfCsvTable, {{"imported_from", kName + ".csv"}, {"sources.gap_1_mm", "b\\c"}}},
      {"target table",
       OfTargetTable,
       {{"imported_from", kName + ".dat"}, {"sources.x_mm", kName}, {"sources.ref_x_mm", kName}}},
      {"laser table", OfLaserTable, {{"imported_from", kName + ".rtl"}}},
      {"hole table", OfHoleTable, {{"imported_from", kName + ".txt"}}},
      {"monitor log", OfMonitorLog, {{"imported_from", kName + ".log"}, {"sources.gap_mm", kName}}},
      {"ballbar", OfBallbar, {{"mounting.ballbar", kName}}},
      {"candump", OfCandump, {{"machine", kName}}},
      {"gap steps",
       [](const fs::path&) { return RecordGapSteps(NamedWorld(), 'X', ShortRun()); },
       {{"machine", kName}}},
      {"dwell",
       [](const fs::path&) {
         const LinkageRig rig = NamedRig();
         return RecordDwell(rig.world(), 'X', &rig, ShortRun());
       },
       {{"machine", kName}}},
      {"course",
       [](const fs::path&) { return NamedRig().Record(ShortCourse(), {.rate = 10.0}); },
       {{"machine", kName}}},
      {"lengths",
       [](const fs::path&) { return RecordLengths(NamedRig(), {.axis = 'X', .count = 3}); },
       {{"machine", kName}}},
      {"plate",
       [](const fs::path&) { return RecordPlate(NamedWorld(), {.holes = 2}); },
       {{"machine", kName}}},
      {"rig's sweep",
       [](const fs::path&) {
         return RecordSweep(NamedWorld(), 'X', Channels(), {.rate = 5.0, .mounting = kName});
       },
       {{"machine", kName}, {"mounting.id", kName}}},
  };
}

TEST(QuotedNames, AreReadAsTheyWere) {
  std::string pattern = (fs::temp_directory_path() / "quoted-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path folder = pattern;
  for (const Written& each : Writers()) {
    SCOPED_TRACE(each.writer);
    const Recording made = each.make(folder);
    ASSERT_GT(made.rows(), 0u);
    for (const char* form : {"written.csv", "written.h5"}) {
      fs::remove(folder / form);
      recording::Write(made, folder / form);
      const Recording read = recording::Read(folder / form);
      EXPECT_EQ(read.header, made.header);
      EXPECT_EQ(read.rows(), made.rows());
      for (const auto& [key, text] : each.says) EXPECT_EQ(read.HeaderText(key), text) << key;
    }
  }
  fs::remove_all(folder);
}

}  // namespace quoted_names_test
}  // namespace abbe::rig
