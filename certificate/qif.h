// The 21 errors of a machine in a QIF 3.0 document: the full parametric specification of a
// Cartesian measuring machine (CartesianCMMFPSTest).
//
//   const std::string text = QifText(certificate);
//   assert(ReadQif(text, "machine.qif") == KeptByQif(certificate));
//
// Frames: value measured less value reported, of the tool against the workpiece: a certificate of
// Sense::kTool. Roll, pitch and yaw: of X about X Y Z, of Y about Y X Z, of Z about Z X Y (the
// schema does not say which of the two is the pitch). Squareness: positive where the angle is
// greater than a right angle, so XZ is -B0Z.
// Units: m, rad. Shapes: as in certificate.h.
// Failure: InputError for a certificate without the 21 errors; with file and line for what is no
// such document.
// Source: QIF 3.0, QIFMeasurementResources.xsd. Validity: QIF has no place for uncertainties; U95
// stands in attributes "U95 EXX", beside those of the certificate.
#pragma once

#include <string>
#include <string_view>

#include "certificate/certificate.h"

namespace abbe::certificate {

// The document, in UTF-8.
std::string QifText(const Certificate& certificate);
// `name` stands for the file in messages.
Certificate ReadQif(std::string_view text, const std::string& name);

// What of a certificate stands in a QIF document: number, item, laboratory's and customer's name,
// temperature, errors with U95, remarks and reservations.
Certificate KeptByQif(const Certificate& certificate);

}  // namespace abbe::certificate
