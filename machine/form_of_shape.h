// A form of an error function from its name and shape, as a file holds them: the inverse of
// FunctionForm::Name() and Shape().
//
//   FormOf(form->Name(), form->Shape())      evaluates as *form does, bit for bit
//
// Units: SI, as in the names of the numbers. Shapes: each number of a shape is a list; one value,
// or the knots or positions in increasing order.
// Failure: InputError for an unknown form (the message lists the forms), for a missing or unknown
// number, and from the maker of the form.
#pragma once

#include <string>
#include <vector>

#include "machine/standard_forms.h"

namespace abbe::machine {

// The form; two calls give two forms that are equal but not shared.
SharedForm FormOf(const std::string& name, const FormShape& shape);

// The names of the numbers of a form, in the order of a file. InputError as above.
std::vector<std::string> ShapeNames(const std::string& name);

}  // namespace abbe::machine
