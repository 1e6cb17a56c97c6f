#include "simulation/linkage/linkage_parts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "random/counter_random.h"
#include "recording/good_rows.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using recording::Column;
using recording::Recording;

constexpr std::uint64_t kSampleStream = 0x5A3;

void Append(const Recording& block, Recording& rows) {
  if (rows.columns.empty()) {
    rows = block;
    return;
  }
  for (std::size_t c = 0; c < rows.columns.size(); ++c) {
    const std::vector<double>& more = block.columns[c].values;
    rows.columns[c].values.insert(rows.columns[c].values.end(), more.begin(), more.end());
  }
}

// Drops the rows before this one of the file.
void DropBefore(std::size_t row, Recording& rows) {
  const std::ptrdiff_t count = row - rows.first_row;
  for (Column& column : rows.columns) {
    column.values.erase(column.values.begin(), column.values.begin() + count);
  }
  rows.first_row = row;
}

std::vector<Index> UpTo(Index count) {
  std::vector<Index> poses(count);
  std::iota(poses.begin(), poses.end(), Index{0});
  return poses;
}

// The `count` poses whose rows draw the smallest numbers, in their order.
LinkageRun Thinned(const LinkageRun& run, Index count) {
  if (run.poses() <= count) return run;
  const random::CounterRandom random(1, kSampleStream);
  std::vector<double> drawn;
  for (const std::size_t row : run.rows) drawn.push_back(random.Uniform(row));
  std::vector<Index> poses = UpTo(run.poses());
  std::nth_element(poses.begin(), poses.begin() + count, poses.end(),
                   [&](Index a, Index b) { return drawn[a] < drawn[b]; });
  poses.resize(count);
  std::sort(poses.begin(), poses.end());
  return Selection(run, poses);
}

}  // namespace

LinkageParts PartsOf(recording::Blocks blocks, relm::LinkageSettings settings) {
  return [blocks = std::move(blocks),
          settings = std::move(settings)](const std::function<void(const LinkageRun&)>& use) {
    Recording rows;  // not handed on yet: the last stay of the blocks before, and a block
    bool any = false;
    const auto hand_on = [&](bool last) {
      if (!recording::HasGoodRow(rows)) return DropBefore(rows.first_row + rows.rows(), rows);
      any = true;
      const LinkageRun means = MeansOfStays(ReadLinkageRun(rows, settings));
      if (last || means.poses() == 1) {
        use(means);
        return DropBefore(rows.first_row + rows.rows(), rows);
      }
      use(Selection(means, UpTo(means.poses() - 1)));
      DropBefore(means.rows.back(), rows);
    };
    std::size_t count = 0;
    blocks([&](const Recording& block) {
      if (rows.rows() > 0) hand_on(false);
      Append(block, rows);
      count += block.rows();
    });
    if (rows.rows() > 0) hand_on(true);
    if (!any) recording::RefuseNoGoodRow(rows, count);
  };
}

LinkageSample SampleOf(const LinkageParts& parts, Index most, Index count) {
  LinkageRun kept;
  Index poses = 0;
  parts([&](const LinkageRun& part) {
    kept = poses == 0 ? Thinned(part, most) : Thinned(Joined(kept, part), most);
    poses += part.poses();
  });
  return {poses > most ? Thinned(kept, count) : kept, poses};
}

}  // namespace abbe::simulation
