// Maps in HDF5 that lie, as recordings do (damaged_hdf5_test.cpp): each is refused in one line with
// what is wrong, in bounded memory. They are inputs of the fuzzing target map_hdf5 too.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <set>
#include <string>

#include "../folders.h"
#include "failure/failure.h"
#include "map/export_grid.h"

namespace abbe::map {
namespace damaged_grid_test {

const std::filesystem::path kDamagedGrids = SourceFolder() / "fuzz/crashes/map_hdf5";

struct LyingGrid {
  const char *file, *says;
};

class DamagedGrid : public testing::TestWithParam<LyingGrid> {};

TEST_P(DamagedGrid, IsRefusedInOneLine) {
  const std::filesystem::path path = kDamagedGrids / GetParam().file;
  try {
    ReadHdf5Grid(path);
    FAIL() << "nothing was refused";
  } catch (const InputError& failure) {
    const std::string message = failure.what();
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    EXPECT_NE(message.find(GetParam().says), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, 1'000'000) << "KiB";
}

constexpr LyingGrid kLyingGrids[] = {
    {"attr_array_machine.h5", "has no text `machine`"},
    {"attr_vlen_array_scale.h5", "has no text `scale`"},
    {"attr_number_chain.h5", "has no text `chain`"},
    {"points_1e9.h5", "than a file of this size can hold"},
    {"positions_1e9.h5", "than a file of this size can hold"},
    {"external_storage.h5", "error_um: its numbers are in other files"},
    {"external_link.h5", "x_mm: is a link to another place"},
    {"soft_link.h5", "y_mm: is a link to another place"},
    {"virtual_tool.h5", "tool_mm: its numbers are in other files"},
    {"group_for_numbers.h5", "error_um"},
    {"another_shape.h5", "error_um: is of 1 x 2 x 2 x 3, the positions are of 3 x 2 x 2 x 3"},
    {"axes_exchanged.h5", "error_um: is of 2 x 2 x 3 x 3, the positions are of 3 x 2 x 2 x 3"},
    {"eight_components.h5", "error_um: is of 1 x 1 x 1 x 8"},
    {"no_positions.h5", "position"},
};
INSTANTIATE_TEST_SUITE_P(Each, DamagedGrid, testing::ValuesIn(kLyingGrids));

TEST(DamagedGrids, AreAllLookedAt) {
  std::set<std::string> listed, there;
  for (const LyingGrid& each : kLyingGrids) listed.insert(each.file);
  for (const auto& entry : std::filesystem::directory_iterator(kDamagedGrids)) {
    there.insert(entry.path().filename().string());
  }
  EXPECT_EQ(listed, there);
}

}  // namespace damaged_grid_test
}  // namespace abbe::map
