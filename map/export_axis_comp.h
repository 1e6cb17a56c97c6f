// Compensation tables of two controls that correct axis by axis: LinuxCNC and Sinumerik.
//
// LinuxCNC: one file for each axis, NAME_x.comp, NAME_y.comp, NAME_z.comp, each line
// "nominal actual actual" in mm (COMP_FILE_TYPE = 0; both directions the same: a map has no
// backlash). The loader of LinuxCNC stops silently at the first line that is not three numbers, so
// the files contain nothing else; at most 256 lines, ascending. It adds nominal - actual to the
// command.
//
// Sinumerik: one file with nine CEC tables, input axis i, output axis k, mm:
//   $AN_CEC[t,n]=value   added to the setpoint of the output axis      t = 3 i + k
// The axes X, Y, Z are called AX1, AX2, AX3.
//
// Frames: a table moves an axis, so its sign is the ToolSense of the axis (machine/chain.h).
// LinuxCNC: actual = nominal + ToolSense * (error in W). The errors are those along three lines
// through the middle of the other two travels. Positions and corrections are in the numbers of the
// control; for an axis that counts as the tool goes, its own table is therefore the same whether it
// carries the tool or the workpiece.
// Failure: InputError with file and line.
// Source: the LinuxCNC manual, COMP_FILE; the Siemens function manual on compensations (K3); the
// signs of LinuxCNC are tested against the program itself.
#pragma once

#include "map/exporter.h"

namespace abbe::map {

inline constexpr int kLinuxcncPoints = 256;

// Each Write returns the files written; each reader gives the error in W that they correct.
Format::Paths WriteLinuxcnc(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path);
ErrorField ReadBackLinuxcnc(const Format::Paths& files, const machine::Chain& chain);

Format::Paths WriteSinumerik(const ErrorMap& map, const ExportOptions& options,
                             const std::filesystem::path& path);
ErrorField ReadBackSinumerik(const Format::Paths& files, const machine::Chain& chain);

// A function along one axis: positions, m, and values; linear between them, constant beyond the
// ends.
struct AxisCurve {
  std::vector<double> positions, values;

  double At(double position) const;
};

// One .comp file: nominal positions and actual - nominal, forward.
AxisCurve ReadComp(const std::filesystem::path& file);

}  // namespace abbe::map
