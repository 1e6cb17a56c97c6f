// The parameters of a calibrated linkage as a certificate states them, with their covariance.
//
//   Certificate certificate = CertificateOfCalibration(calibration);
//
// Units: SI, of each block; a temperature coefficient in 1/K. Shapes: a series for each block of
// parameters; the free ones together with their covariance.
// Failure: InputError for an uncertainty that is not finite: the data and the priors leave it open.
// Source: own. Validity: a mapped calibration is stated by its global parameters, and says so.
#pragma once

#include "certificate/certificate.h"
#include "fusion/calibration.h"

namespace abbe::certificate {

// Title, methods, remarks and results; the rest is left empty.
Certificate CertificateOfCalibration(const fusion::Calibration& calibration);

}  // namespace abbe::certificate
