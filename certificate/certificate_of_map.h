// The results of an error map as a certificate states them: the 21 errors with U95, and the
// parameters of the map with their covariance.
//
//   Certificate certificate = CertificateOfMap(map, 13, Sense::kCarriages);
//
// Frames: kCarriages: the errors of the carriages, as in the map (machine/volumetric_error.h);
// kTool: as a measuring machine states them, of the tool against the workpiece
// (map/axis_tables.h). Units: SI. Shapes: `count` positions along each axis, at least 2; axes that
// the machine does not have have no errors.
// Failure: InputError for a map without uncertainty; with kTool for a machine that lacks an axis or
// counts an axis against the tool. Source: own. Validity: U95 of first order; with
// kTool it contains what the turns of a carriage do to the straightness of the tool.
#pragma once

#include "certificate/certificate.h"
#include "map/error_map.h"

namespace abbe::certificate {

enum class Sense { kCarriages, kTool };

// Title, methods, remarks on the scale, temperature and results; the rest is left empty.
Certificate CertificateOfMap(const map::ErrorMap& map, Eigen::Index count, Sense sense);

}  // namespace abbe::certificate
