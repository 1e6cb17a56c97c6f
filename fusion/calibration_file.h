// The file of a calibration: TOML, written by `abbe calibrate`, read with --calibration.
//
//   format = 1
//   machine = "demo-mill"
//   model = "complete"            # a name of relm/error_model_name.h
//   displacement = false
//   mountings = [""]
//   held_out_rms_um = 0.74        # if poses were held out
//   [[parameter]]                 # every parameter in the order of the model, the bases first
//   name = "tilt.pivot_1_u"
//   value = 312.4                 # in `unit`, like all numbers of this table
//   uncertainty = 4.1             # left out: not determined
//   nominal = 0.0
//   prior = 500.0                 # left out: none
//   held = false
//   unit = "urad"
//   [covariance]
//   names = [...]                 # free parameters
//   rows = [...]                  # row after row, SI
//   [mapped]                      # with --mapped only
//   x_mm = [...]  y_mm = [...]  z_mm = [...]      # cell centres
//   [[mapped.cell]]               # z runs fastest, then y, then x
//   values = [...]                # SI, parameters of the model
//
// Numbers are written in full: read back they differ by the rounding of the unit, 2e-16.
// Frames: those of Calibration.
// Units: as each table says; the covariance SI. Shapes: the covariance as its whole rows, free
// parameters only.
// Failure: InputError with file, line and key; for a parameter that is missing, unknown or out of
// order, the message names it.
// Source: own format, version 1.
// Validity: a file is read with the machine file that it was made with, or one with the same model.
#pragma once

#include <filesystem>

#include "fusion/calibration.h"

namespace abbe::fusion {

// Under a temporary name first, then renamed. Missing folders are made.
void WriteCalibration(const Calibration& calibration, const std::filesystem::path& path);

// `settings` gives the model its blocks, with units and names; values come from the file.
Calibration ReadCalibration(const std::filesystem::path& path,
                            const relm::LinkageSettings& settings);

}  // namespace abbe::fusion
