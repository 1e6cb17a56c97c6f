// A form of an error function from its name and shape, as a file holds them: the inverse of
// FunctionForm::Name() and Shape().
//
//   FormOf(form->Name(), form->Shape())      evaluates as *form does, bit for bit
//
// Units: SI, as the names of the numbers say. Failure: InputError for a name that is no form (it
// lists the forms), a number that is missing or unknown, and whatever the maker refuses.
#pragma once

#include <string>
#include <vector>

#include "machine/standard_forms.h"

namespace abbe::machine {

SharedForm FormOf(const std::string& name, const FormShape& shape);

// The names of the numbers of a form, in the order of a file. InputError as above.
std::vector<std::string> ShapeNames(const std::string& name);

}  // namespace abbe::machine
