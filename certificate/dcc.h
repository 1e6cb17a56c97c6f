// A certificate as a Digital Calibration Certificate: DCC 3.2.0 with D-SI 2.1 (PTB).
//
//   const std::string text = DccText(certificate);
//   const Certificate again = ReadDcc(text, "certificate.xml");
//   assert(again == certificate);  // to the last bit
//
// Units: SI in the notation of D-SI ("\metre"). Shapes: as in certificate.h; the covariance in
// full.
// Failure: InputError with file and line for what is no DCC, or none that this program wrote.
// Source: the schemas of PTB, dcc 3.2.0 and D-SI 2.1.0. Validity: a reader for own certificates; the
// refTypes `abbe_...` say what an element holds. A signature is not checked.
#pragma once

#include <string>
#include <string_view>

#include "certificate/certificate.h"

namespace abbe::certificate {

// The document, in UTF-8.
std::string DccText(const Certificate& certificate);

// `name` stands for the file in messages.
Certificate ReadDcc(std::string_view text, const std::string& name);

}  // namespace abbe::certificate
