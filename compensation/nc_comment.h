// A comment of an NC program as the corrected program has it.
//
//   CommentText("(debug, depth #1)", 7, parameters);      // "(debug, depth 2.000000)"
//
// Comments that show values (debug, print, log) get the values of their parameters, as the control
// would show them; all others stay as they are. Failure: InputError for (abort, ...), which ends a
// program. Source: LinuxCNC 2.9, comments. For nc_correction.cpp alone.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "compensation/nc_parameters.h"

namespace abbe::compensation {

// `text` with its parentheses.
std::string CommentText(std::string_view text, std::size_t line_number,
                        const NcParameters& parameters);

}  // namespace abbe::compensation
