// The program of a planned path for the control.
#include "investigate/control_program.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace control_program_test {

recording::Recording Path(const std::vector<std::vector<double>>& rows) {
  recording::Recording path;
  path.name = "planned";
  for (const char* name : {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min"}) {
    path.columns.push_back({name, {}});
  }
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) path.columns[i].values.push_back(row[i]);
  }
  return path;
}

// By the G-code reference of LinuxCNC: G1 moves straight at F, G4 P stands for seconds.
TEST(ControlProgram, StandsAndMovesAsThePathDoes) {
  const auto path = Path({{0.0, 0, 0, 0, 1, 1, 300},
                          {0.7, 0, 0, 0, 1, 1, 300},
                          {2.0, 10, 0, 0, 1, 1, 300},
                          {3.0, 10, 5, 0, 1, 1, 300}});
  EXPECT_EQ(investigate::ControlProgram(path, "a run (X)"),
            "(a run [X])\n(written by abbe: look for collisions first)\n"
            "G17 G21 G90 G94\nG64 P0.002\nF300\n"
            "G1 X0.00000 Y0.00000 Z0.00000\nG4 P0.700\n"
            "G1 X10.00000 Y0.00000 Z0.00000\n"
            "G1 X10.00000 Y5.00000 Z0.00000\nG4 P1.000\nM2\n");
}

// The axes have moved before a closed path counts: a quarter of it before, a quarter after.
TEST(ControlProgram, RunsInToAClosedPath) {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * 0.25 * 3.14159265358979;
    rows.push_back({1.0 * i, 10 * std::cos(angle), 10 * std::sin(angle), 0, 1, 1, 600});
  }
  const std::string program = investigate::ControlProgram(Path(rows), "circle");
  std::size_t moves = 0;
  for (auto at = program.find("G1 "); at != std::string::npos; at = program.find("G1 ", at + 1)) {
    ++moves;
  }
  EXPECT_EQ(moves, 8u + 2u + 2u) << program;
  EXPECT_NE(program.find("G64 P0.002\nF600\nG1 X0.00000 Y-10.00000"), std::string::npos) << program;
}

}  // namespace control_program_test
}  // namespace abbe
