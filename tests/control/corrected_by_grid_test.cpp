// The exported grid in the core of LinuxCNC's component against abbe correct: the same commands for
// every chain, way of counting and tool, up to the chords of the grid.
#include <gtest/gtest.h>

#include <array>

#include "compensation/corrector.h"
#include "control/linuxcnc/abbe_grid.h"
#include "failure/failure.h"
#include "map/exporter.h"
#include "map/text_file.h"
#include "map_cases.h"

namespace abbe::control {
namespace corrected_by_grid_test {

using Eigen::Vector3d;
using machine::Positive;

class Component {
 public:
  explicit Component(const std::filesystem::path& file) {
    char reason[ABBE_GRID_REASON] = "";
    EXPECT_EQ(abbe_grid_read(file.c_str(), &grid_, reason), 1) << reason;
  }
  ~Component() { abbe_grid_free(&grid_); }
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  // m.
  Vector3d Command(const Vector3d& wanted, const Vector3d& tool_offset) const {
    abbe_offsets now = {};
    abbe_period period = {{}, {}, {}, 1e9, 1, 1, 1};
    for (int k = 0; k < 3; ++k) {
      period.position[k] = 1e3 * wanted[k];
      period.tool_offset[k] = 1e3 * tool_offset[k];
    }
    for (int i = 0; i < 3; ++i) abbe_offsets_step(&grid_, &period, &now);
    EXPECT_EQ(now.is_outside + now.is_limited, 0);
    return wanted + 1e-3 * Vector3d(now.offset);
  }

 private:
  abbe_grid grid_;
};

// Chords of 1.5 mm across functions of 2 um and 20 urad with knots each 12 mm, arms of 0.2 m. A
// wrong sign or a tool that is forgotten: 10 um.
constexpr double kChords = 200e-9;

TEST(CorrectedByGrid, TheComponentCommandsWhatAbbeCorrectWrites) {
  const map::Folder folder;
  const Vector3d gauge(0.01, -0.02, -0.08), longer(0.003, -0.002, 0.12);
  std::uint64_t seed = 70;
  for (const char* const chain :
       {map::kColumn, map::kBridge, "[w Y b X Z t]", "[w Z X b Y t]", "[w X Y Z b t]"}) {
    for (const auto positive : {Positive::kTool, Positive::kCarriage}) {
      const map::ErrorMap map =
          Counted(map::RandomMap(++seed, chain), {positive, Positive::kCarriage, positive});
      SCOPED_TRACE(std::string(chain) + " " + map.model().chain().PositiveText());
      const map::ExportOptions options{{41, 41, 41}, gauge};
      map::FormatNamed("linuxcnc-hal").write(map, options, folder / "mill.hal");
      const Component component(folder / "mill.grid");
      double largest = 0.0;
      for (std::uint64_t i = 0; i < 30; ++i) {
        const Vector3d wanted = map::RandomPlace(map, seed, i);
        const Vector3d offset = i % 2 == 0 ? longer : Vector3d::Zero();
        // docs/correct.md: a length offset t moves the point by -S t.
        const Vector3d p_TQ = gauge - map.model().chain().ToolSenses().cwiseProduct(offset);
        const Vector3d command = compensation::Corrector(map, p_TQ).Command(wanted);
        EXPECT_LT((component.Command(wanted, offset) - command).norm(), kChords);
        largest = std::max(largest, (command - wanted).norm());
      }
      EXPECT_GT(largest, 5e-6);
    }
  }
}

TEST(CorrectedByGrid, AnExportThatTheComponentWouldRefuseIsRefused) {
  const map::Folder folder;
  const map::ErrorMap map = map::RandomMap(1);
  const auto refusal = [&](map::ExportOptions options, const char* name) {
    return map::MessageOf<InputError>(
        [&] { map::FormatNamed("linuxcnc-hal").write(map, options, folder / name); });
  };
  map::ExpectHas(refusal({{101, 101, 101}, Vector3d::Zero()}, "a.hal"), "give fewer with --points");
  map::ExpectHas(refusal({{3, 3, 3}, Vector3d::Zero()}, "my mill.hal"), "cannot name");
  map::ExpectHas(refusal({{3, 3, 3}, Vector3d::Zero()}, "mill.grid"), "the name of the grid");
  map::ExpectHas(refusal({{3, 3, 3}, Vector3d(0, 0, -1e4)}, "a.hal"), "none of 10 mm or more");
}

TEST(CorrectedByGrid, TheHalFileLoadsItsGrid) {
  const map::Folder folder;
  const map::ExportOptions options{{2, 2, 2}, Vector3d::Zero()};
  const auto files =
      map::FormatNamed("linuxcnc-hal").write(map::RandomMap(1), options, folder / "deep/mill.hal");
  ASSERT_EQ(files, (map::Format::Paths{folder / "deep/mill.hal", folder / "deep/mill.grid"}));
  map::ExpectHas(map::ReadWhole(files[0]), "loadrt abbe_map grid=mill.grid\n");
}

}  // namespace corrected_by_grid_test
}  // namespace abbe::control
