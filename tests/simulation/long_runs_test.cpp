// A recording that is read block by block says what it says as a whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulation/linkage/linkage_parts.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::simulation {
namespace long_runs_test {

using fusion::Campaign;
using fusion::CampaignMachine;
using recording::Recording;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Campaign& World() {
  static const Campaign campaign(CampaignMachine({{"step_mm = 4.0", "step_mm = 10.0"}}), 3);
  return campaign;
}

recording::Blocks Cut(const Recording& whole, std::size_t rows) {
  return [whole, rows](const recording::UseBlock& use) {
    for (std::size_t first = 0; first < whole.rows(); first += rows) {
      Recording block = whole;
      block.first_row = first;
      const std::size_t last = std::min(whole.rows(), first + rows);
      for (recording::Column& column : block.columns) {
        column.values.erase(column.values.begin() + static_cast<std::ptrdiff_t>(last),
                            column.values.end());
        column.values.erase(column.values.begin(),
                            column.values.begin() + static_cast<std::ptrdiff_t>(first));
      }
      use(block);
    }
  };
}

std::vector<double>& ColumnOf(Recording& recording, const std::string& name) {
  for (recording::Column& column : recording.columns) {
    if (column.name == name) return column.values;
  }
  throw std::logic_error(name);
}

// Stays begin in one block and end in the next; some blocks have flagged rows, one has no other.
TEST(LinkageParts, AreTheMeansOfTheStaysOfTheWhole) {
  Recording recording = World().LinkageRecording(3);
  auto& flags = ColumnOf(recording, "flags");
  for (std::size_t row = 40; row < 100; ++row) flags[row] = 1.0;
  const LinkageRun whole = MeansOfStays(ReadLinkageRun(recording, World().linkage));
  ASSERT_GT(whole.samples.maxCoeff(), 3.0);
  ASSERT_LT(whole.samples.maxCoeff(), 25.0);
  for (const std::size_t rows : {25u, 64u, 100'000u}) {
    const LinkageRun sample =
        SampleOf(PartsOf(Cut(recording, rows), World().linkage), whole.poses(), 1).run;
    EXPECT_EQ(sample.rows, whole.rows);
    EXPECT_EQ(sample.readings.angles, whole.readings.angles);
    EXPECT_EQ(sample.commanded, whole.commanded);
    EXPECT_EQ(sample.samples, whole.samples);
    EXPECT_EQ(sample.time, whole.time);
  }
}

TEST(LinkageParts, AStayLongerThanABlockIsCutAndNoRowIsLost) {
  const Recording recording = World().LinkageRecording(2);
  const LinkageRun whole = MeansOfStays(ReadLinkageRun(recording, World().linkage));
  double rows = 0.0;
  PartsOf(Cut(recording, 2),
          World().linkage)([&](const LinkageRun& part) { rows += part.samples.sum(); });
  EXPECT_EQ(rows, whole.samples.sum());
}

TEST(LinkageParts, NameTheRowOfTheFile) {
  Recording recording = World().LinkageRecording(2);
  ColumnOf(recording, "pivot_2_rad")[25] += 2.0 * std::numbers::pi;
  const auto go = [&] { PartsOf(Cut(recording, 25), World().linkage)([](const LinkageRun&) {}); };
  EXPECT_THAT(go, ThrowsMessage<InputError>(HasSubstr("row 26: pivot_2_rad jumps")));
  for (double& flag : ColumnOf(recording, "flags")) flag = 1.0;
  EXPECT_THAT(go, ThrowsMessage<InputError>(
                      HasSubstr(fmt::format("all {} rows are flagged", recording.rows()))));
}

// A quarter of 60 poses drawn stands in each quarter of the run, and half at even places: within
// four standard deviations of a binomial.
TEST(LinkageSample, IsSpreadEvenly) {
  const LinkageParts parts = PartsOf(Cut(World().LinkageRecording(5), 300), World().linkage);
  const LinkageSample all = SampleOf(parts, 100'000, 1);
  const LinkageSample some = SampleOf(parts, 100, 60);
  ASSERT_GT(all.poses, 120);
  EXPECT_EQ(some.poses, all.poses);
  ASSERT_EQ(some.run.poses(), 60);
  std::array<double, 4> quarters{};
  double even = 0.0;
  for (const std::size_t row : some.run.rows) {
    const auto at = std::find(all.run.rows.begin(), all.run.rows.end(), row);
    ASSERT_NE(at, all.run.rows.end());
    const auto place = static_cast<std::size_t>(at - all.run.rows.begin());
    quarters[4 * place / all.run.rows.size()] += 1.0;
    even += place % 2 == 0 ? 1.0 : 0.0;
  }
  for (const double quarter : quarters) {
    EXPECT_NEAR(quarter, 15.0, 4.0 * std::sqrt(60.0 * 0.25 * 0.75));
  }
  EXPECT_NEAR(even, 30.0, 4.0 * std::sqrt(60.0 * 0.5 * 0.5));
}

TEST(SweepInBlocks, IsTheSweep) {
  const Recording recording = World().SweepRecording('Y');
  const SweepRun whole = ReadSweepRun(recording, World().instrument.head, World().noise);
  Recording head = recording;
  for (recording::Column& column : head.columns) column.values.clear();
  for (const std::size_t rows : {7u, 100u}) {
    const SweepRun run =
        ReadSweepRun(head, Cut(recording, rows), World().instrument.head, World().noise);
    EXPECT_EQ(run.gap, whole.gap);
    EXPECT_EQ(run.position, whole.position);
    EXPECT_EQ(run.first_rows, whole.first_rows);
    EXPECT_EQ(run.start, whole.start);
    EXPECT_EQ(run.covariance, whole.covariance);
  }
}

}  // namespace long_runs_test
}  // namespace abbe::simulation
