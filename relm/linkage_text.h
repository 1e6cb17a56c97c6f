// The machine file of an arm with other numbers of its geometry; everything else stays as it is,
// comments too.
//
//   const std::string text = WithGeometry(old_text, written, u95, "arm.toml");
//
// In [linkage] the rows (`joint`), or the axes (`axis`), and `ball_mm` are replaced by inline ones;
// a comment behind each states the expanded uncertainties. Degrees to 1e-8, millimetres to 1e-6,
// directions to 1e-12. `u95`: of WrittenChain::Numbers, SI; 0: held, nothing is stated.
// Frames: of the text: those of WrittenChain.
// Units: SI inside; degrees and millimetres in the text. Shapes: `u95` as WrittenChain::Numbers.
// Failure: InputError where the text, read again, would not have this geometry (keys written in an
// unusual way).
// Validity: numbers rounded as said: 1e-12 of a direction is 1e-12 m at 1 m.
#pragma once

#include <Eigen/Core>
#include <string>

#include "relm/chain_rows.h"

namespace abbe::relm {

// The whole text; `name` is that of the file in messages.
std::string WithGeometry(const std::string& text, const WrittenChain& written,
                         const Eigen::VectorXd& u95, const std::string& name);

}  // namespace abbe::relm
