// A calibration certificate as data: what dcc.h and qif.h write and read.
//
//   Certificate certificate = CertificateOfMap(map, 13, Sense::kCarriages);
//   certificate.administration = ReadAdministration(document.Root());
//   certificate.doubts = DoubtsOfResult(result);
//
// Units: SI, named by `unit` ("m", "rad", "N/m", ...); a figure that is judged keeps the unit that
// its limit has ("um", "urad"). Shapes: U95 and labels are as long as values, or empty; positions
// are as long as values, or empty where the result is one number; the covariance N x N in rows, for
// N names.
// Failure: none, it is data. Validity: U95 = coverage * u.
#pragma once

#include <string>
#include <vector>

#include "certificate/administration.h"
#include "standards/coverage.h"

namespace abbe::certificate {

// One result: a curve, a list of numbers with labels, or a number.
struct Series {
  std::string name, words;  // "EXX", "positioning of X; determined by: sweep"
  std::string unit;
  std::vector<std::string> labels;
  std::vector<double> positions;  // m
  std::vector<double> values, U95;
  bool operator==(const Series&) const = default;
};

// Numbers with their covariance.
struct Joint {
  std::string words;
  std::vector<std::string> names, units;
  std::vector<double> values, covariance;
  bool operator==(const Joint&) const = default;
};

// A figure against its limit. `status`: "pass", "fail", and where neither is proven
// "conditionalPass" (within the limit) or "conditionalFail" (beyond it).
struct Conformity {
  std::string name, unit, status;
  double value = 0.0, U95 = 0.0, limit = 0.0;
  bool operator==(const Conformity&) const = default;
};

struct Certificate {
  Administration administration;
  std::string title;  // of the results
  std::string software = "abbe";
  std::string release;               // of the program
  std::vector<std::string> methods;  // how it was measured, which signs hold
  std::vector<std::string> remarks;  // what the reader must know
  std::vector<std::string> doubts;   // for which no conformity is stated
  std::vector<double> temperature;   // degC, of the machine; none where the result states none
  double coverage = standards::kCoverage;
  std::vector<Series> results;
  std::vector<Joint> joint;  // at most one
  std::vector<Conformity> conformities;
  bool operator==(const Certificate&) const = default;
};

}  // namespace abbe::certificate
