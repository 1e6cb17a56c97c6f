#include "machine/form_of_shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "machine/tanh_network.h"

namespace abbe::machine {
namespace {

using Maker = SharedForm (*)(const FormShape&);

struct KnownForm {
  const char* name;
  std::vector<std::string> numbers;
  Maker make;
};

double One(const FormShape& shape, const std::string& name) {
  const std::vector<double>& numbers = shape.at(name);
  if (numbers.size() != 1) {
    throw InputError(fmt::format("{} has {} numbers where it takes one", name, numbers.size()));
  }
  return numbers[0];
}

int Whole(const FormShape& shape, const std::string& name) {
  const double number = One(shape, name);
  if (number != std::floor(number) || std::abs(number) > 1e6) {
    throw InputError(fmt::format("{} = {} must be a whole number", name, number));
  }
  return static_cast<int>(number);
}

SharedForm Network(const FormShape& shape, NetworkBias bias) {
  return MakeTanhNetwork(Whole(shape, "neurons"), One(shape, "gain_per_m"), bias);
}

SharedForm Polynomial(const FormShape& shape) {
  const std::vector<double>& interval = shape.at("interval_m");
  if (interval.size() != 2) throw InputError("interval_m must be [first, last]");
  return MakePolynomialForm(Whole(shape, "degree"), interval[0], interval[1]);
}

const std::vector<KnownForm>& Forms() {
  static const std::vector<KnownForm> forms = {
      {"b-spline",
       {"degree", "knots_m"},
       [](const FormShape& s) {
         return MakeBSplineForm(geometry::BSplineBasis(Whole(s, "degree"), s.at("knots_m")));
       }},
      {"table",
       {"positions_m"},
       [](const FormShape& s) { return MakeTableForm(s.at("positions_m")); }},
      {"polynomial", {"degree", "interval_m"}, Polynomial},
      {"fourier",
       {"harmonics", "period_m"},
       [](const FormShape& s) {
         return MakeFourierForm(Whole(s, "harmonics"), One(s, "period_m"));
       }},
      {"network",
       {"neurons", "gain_per_m"},
       [](const FormShape& s) { return Network(s, NetworkBias::kAsPrinted); }},
      {"network with bias",
       {"neurons", "gain_per_m"},
       [](const FormShape& s) { return Network(s, NetworkBias::kWithBias); }},
  };
  return forms;
}

const KnownForm& Find(const std::string& name) {
  std::vector<std::string> known;
  for (const KnownForm& form : Forms()) {
    if (form.name == name) return form;
    known.emplace_back(form.name);
  }
  throw InputError(fmt::format("\"{}\" is not a form of an error function; write \"{}\"", name,
                               fmt::join(known, "\", \"")));
}

}  // namespace

std::vector<std::string> ShapeNames(const std::string& name) { return Find(name).numbers; }

SharedForm FormOf(const std::string& name, const FormShape& shape) {
  const KnownForm& form = Find(name);
  for (const std::string& number : form.numbers) {
    if (!shape.contains(number)) {
      throw InputError(fmt::format("the form \"{}\" lacks {}", name, number));
    }
  }
  if (shape.size() != form.numbers.size()) {
    throw InputError(
        fmt::format("the form \"{}\" takes {} only", name, fmt::join(form.numbers, ", ")));
  }
  return form.make(shape);
}

}  // namespace abbe::machine
