// The coverage factor of expanded uncertainties unless stated otherwise: U95 = 2 u, as the GUM
// (ISO/IEC Guide 98-3:2008, 6.3.3) suggests for normal errors (95.45 %).
#pragma once

namespace abbe::standards {

inline constexpr double kCoverage = 2.0;

}  // namespace abbe::standards
