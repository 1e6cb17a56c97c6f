// The error models of the linkage and their names: the one table for options, calibration files
// and reports.
//
//   ErrorModelNamed("published-with-bearing") == ErrorModel::kPublishedWithBearing
//
// error_models.h has the models themselves, docs/theory-linkage.md their derivation.
// Failure: InputError that lists the names.
// Source: Boelens (2006) for the published ones, the RELM paper for the pivots, own for the
// complete one.
// Validity: a name says nothing of the parameters; error_models.h does.
#pragma once

#include <string>

namespace abbe::relm {

enum class ErrorModel { kPivots, kPublished, kPublishedWithBearing, kComplete };

// "published-with-bearing".
std::string ErrorModelName(ErrorModel model);

// Also reads blanks in the place of hyphens, as calibration files of earlier versions have them.
// InputError that lists the names for any other text.
ErrorModel ErrorModelNamed(std::string name);

// "pivots, published, published-with-bearing, complete"
std::string ErrorModelNames();

}  // namespace abbe::relm
