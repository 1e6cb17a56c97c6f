// The compensation tables of two controls that correct axis by axis.
//
// LinuxCNC: one file for each axis, NAME_x.comp, NAME_y.comp, NAME_z.comp, each line
// "nominal actual actual" in mm (COMP_FILE_TYPE = 0; both directions the same: a map has no
// backlash). Its loader stops without a word at the first line that is not three numbers, so the
// files hold nothing else; at most 256 lines, ascending. It adds nominal - actual to the command.
//
// Sinumerik: one file with nine CEC tables, input axis i, output axis k, mm:
//   $AN_CEC[t,n]=value   added to the setpoint of the output axis      t = 3 i + k
// The axes X, Y, Z are called AX1, AX2, AX3.
//
// Frames: a table moves an axis, so for an axis that carries the workpiece its sign is that of the
// carriage, ToolSense (machine/chain.h). LinuxCNC: actual = nominal + sign * (error in W).
// The lines run through the middle of the other two travels.
// Positions and corrections are in the numbers of the control, so a table of an axis onto itself
// says the same for an axis that counts as the tool goes, whichever side it stands on.
// Failure: InputError with file and line.
// Source: the LinuxCNC manual, COMP_FILE; the Siemens function manual on compensations (K3); the
// signs of LinuxCNC are tested against the program itself.
#pragma once

#include "map/exporter.h"

namespace abbe::map {

inline constexpr int kLinuxcncPoints = 256;

Format::Paths WriteLinuxcnc(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path);
ErrorField ReadBackLinuxcnc(const Format::Paths& files, const machine::Chain& chain);

Format::Paths WriteSinumerik(const ErrorMap& map, const ExportOptions& options,
                             const std::filesystem::path& path);
ErrorField ReadBackSinumerik(const Format::Paths& files, const machine::Chain& chain);

// Along one axis: positions, m, and a value at each; straight lines between, the end values
// beyond.
struct AxisCurve {
  std::vector<double> positions, values;

  double At(double position) const;
};

// Of one .comp: nominal positions and actual - nominal, forward.
AxisCurve ReadComp(const std::filesystem::path& file);

}  // namespace abbe::map
