// A real machine that grows while it warms up: the place of the Z end stop of a large 3D printer
// against its frame and bed (tanaes/whopping_Voron_mods 62268ed, docs/frame_expansion/data). Every
// second block of 20 rows is held out. NumPy's lstsq leaves 37.2 um there by the frame alone, 4.4
// um with the bed and 3.0 um with a lag besides.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "../folders.h"
#include "failure/failure.h"
#include "track/series.h"

namespace abbe::track {
namespace frame_growth_field_test {

using Eigen::Index;

constexpr double kMicrostep = 2.5;  // um

std::filesystem::path Folder() { return FieldData() / "voron-frame-expansion"; }

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

Series ReadSeries(const std::string& name, const std::vector<std::string>& sensors) {
  std::ifstream file(Folder() / name);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.front() != '#') rows.push_back(Cells(line));
  }
  std::map<std::string, std::size_t> at;
  for (std::size_t i = 0; i < rows.front().size(); ++i) at[rows.front()[i]] = i;
  const Index count = std::ssize(rows) - 1;
  Series series{.name = name,
                .time = Eigen::VectorXd(count),
                .value = Eigen::VectorXd(count),
                .sensors = sensors,
                .temperature = Eigen::MatrixXd(std::ssize(sensors), count)};
  for (Index row = 0; row < count; ++row) {
    const auto& cells = rows[static_cast<std::size_t>(row) + 1];
    std::tm when{};
    std::istringstream(cells[at["time"]]) >> std::get_time(&when, "%Y/%m/%d-%H:%M:%S");
    series.time[row] = static_cast<double>(timegm(&when));
    series.value[row] = kMicrostep * std::stod(cells[at["mcu_pos_z"]]);
    for (Index s = 0; s < std::ssize(sensors); ++s) {
      series.temperature(s, row) = std::stod(cells[at[sensors[static_cast<std::size_t>(s)]]]);
    }
  }
  return series;
}

struct HeldOut {
  double rms = 0.0, inside = 0.0;
};

HeldOut Judge(const Series& series) {
  std::vector<bool> held_out(static_cast<std::size_t>(series.value.size()));
  for (std::size_t row = 0; row < held_out.size(); ++row) held_out[row] = row / 20 % 2 == 1;
  const SeriesResponse response = LearnResponse(series, held_out);
  HeldOut judged;
  double count = 0.0;
  for (Index row = 0; row < series.value.size(); ++row) {
    if (!held_out[static_cast<std::size_t>(row)]) continue;
    const double off = response.value[row] - series.value[row];
    judged.rms += off * off;
    judged.inside += std::abs(off) < 2.0 * response.u[row] ? 1.0 : 0.0;
    count += 1.0;
  }
  for (const SeriesSensor& each : response.sensors) {
    fmt::print("  {}: {:.2f} +- {:.2f} um/K, lag {:.0f} s\n", each.sensor, each.gain,
               2.0 * each.u_gain, each.lag);
  }
  judged.rms = std::sqrt(judged.rms / count);
  judged.inside /= count;
  fmt::print(
      "  walk {:.2f} um after an hour, noise {:.2f} um; held out {:.2f} um, {:.1f} % in U95\n",
      response.walk, response.noise, judged.rms, 100.0 * judged.inside);
  return judged;
}

TEST(FrameGrowthField, FollowsFrameAndBed) {
  if (!std::filesystem::exists(Folder())) GTEST_SKIP() << "skipped: field data not found";
  const std::string name = "frame_exp_quant_v3_2021-06-13_05-41-53.csv";
  const HeldOut judged = Judge(ReadSeries(name, {"frame_t", "bed_t"}));
  EXPECT_LE(judged.rms, 3.0);
  // 600 rows whose errors go on from one to the next: a tenth as many are independent.
  EXPECT_NEAR(judged.inside, 0.95, 3.0 * std::sqrt(0.95 * 0.05 / 60.0));
}

TEST(FrameGrowthField, RefusesGrossJumps) {
  if (!std::filesystem::exists(Folder())) GTEST_SKIP() << "skipped: field data not found";
  const std::string name = "frame_temp_v_pos_2021-06-05_13-24-32.csv";
  try {
    Judge(ReadSeries(name, {"frame_t", "bed_t"}));
    FAIL() << "a series with lost steps was taken";
  } catch (const InputError& error) {
    fmt::print("  {}\n", error.what());
    EXPECT_NE(std::string(error.what()).find("jumps by"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("lost steps"), std::string::npos) << error.what();
  }
}

}  // namespace frame_growth_field_test
}  // namespace abbe::track
