// The files of LinuxCNC that say what an NC program leaves to its control: parameters and tools.
//
//   NcTables tables;
//   tables.parameters = ReadParameters("linuxcnc.var");     // "5221<tab>12.5" a line
//   tables.tools = ReadTools("tool.tbl");                    // "T3 P3 Z51.2 D6 ;end mill"
//   tables.ini = ReadIniNumbers("mill.ini");                 // #<_ini[toolsensor]x>
//
// Units: those of the machine, as in the files; NcTables::unit is one of them in m.
// Frames: machine coordinates. Shapes: X, Y, Z. Validity: LinuxCNC's formats.
// Failure: InputError with file and line for a line that is none of theirs, a number or a tool
// given twice. Source: LinuxCNC 2.9, integrator manual (tool table; parameter file).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "compensation/nc_offsets.h"

namespace abbe::compensation {

struct NcTool {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double diameter = 0.0;
  int orientation = 0;  // of a turning tool, Q
};

struct NcTables {
  std::optional<std::map<int, double>> parameters;
  std::optional<std::map<int, NcTool>> tools;
  double unit = 1e-3;  // m
  // Numbers of the control's INI file, "SECTION]KEY"; the program has no others.
  std::optional<std::map<std::string, double>> ini = {};
};

// "number value" a line.
std::map<int, double> ReadParameters(const std::filesystem::path& path);
// By the number of the tool, T.
std::map<int, NcTool> ReadTools(const std::filesystem::path& path);

// "SECTION.KEY" -> number; other values are left out (settings/ini_text.h).
std::map<std::string, double> ReadIniNumbers(const std::filesystem::path& path);

// The offsets that a control with these parameters starts with.
NcOffsets OffsetsOf(const NcTables& tables);

}  // namespace abbe::compensation
