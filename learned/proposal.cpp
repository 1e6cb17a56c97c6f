#include "learned/proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace abbe::learned {

using Form = Atom::Form;

namespace {

constexpr int kBorders = 31, kAtEnds = 1;  // between 32 parts of a range
constexpr double kWaveStep = 0.4, kMostWaves = 12.0;
constexpr int kLogSteps = 14;

bool IsTimeLike(const std::string& variable) {
  return variable.starts_with("time") || variable.starts_with("way of ") ||
         variable.starts_with("warming of ") || variable.starts_with("column ");
}

NumberGrid Logarithmic(double first, double last) {
  NumberGrid grid{{}, true, std::log(last / first)};
  for (int i = 0; i < kLogSteps; ++i) {
    grid.numbers.push_back(first *
                           std::pow(last / first, static_cast<double>(i) / (kLogSteps - 1)));
  }
  return grid;
}

}  // namespace

simulation::Expression Proposal::expression() const {
  simulation::Expression expression{{atoms}};
  if (columns() == 2) {
    expression.terms.push_back(atoms);
    for (Atom& atom : expression.terms.back()) {
      if (atom.form == Form::kSine) atom.form = Form::kCosine;
    }
  }
  return expression;
}

std::size_t Proposal::columns() const {
  return std::ranges::any_of(atoms, [](const Atom& atom) { return atom.form == Form::kSine; }) ? 2
                                                                                               : 1;
}

const std::vector<Form>& Forms() {
  static const std::vector<Form> forms{Form::kLinear, Form::kSquare, Form::kAbsolute,
                                       Form::kStep,   Form::kKink,   Form::kSine,
                                       Form::kDecay,  Form::kLag,    Form::kPlay};
  return forms;
}

bool HasNumber(Form form) {
  return form != Form::kLinear && form != Form::kSquare && form != Form::kAbsolute &&
         form != Form::kSign;
}

NumberGrid GridOf(Form form, const std::string& variable, const diagnosis::Range& range) {
  constexpr double kFastest = 0.003, kSlowest = 2.0, kFine = 0.005, kWide = 0.5;  // of the range
  constexpr double kShortLag = 60.0, kLongLag = 7200.0;                           // s
  NumberGrid grid{{}, false, range.Length()};
  switch (form) {
    case Form::kStep:
    case Form::kKink:
      // At an end of the range a kink is a straight line, a step nothing.
      for (int i = 1 + kAtEnds; i <= kBorders - kAtEnds; ++i) {
        grid.numbers.push_back(range.first + range.Length() * i / (kBorders + 1));
      }
      break;
    case Form::kSine:
      grid.length = kMostWaves / range.Length();
      for (double waves = 1.0; waves <= kMostWaves; waves += kWaveStep) {
        grid.numbers.push_back(range.Length() / waves);
      }
      break;
    case Form::kDecay:
      return Logarithmic(kFastest * range.Length(), kSlowest * range.Length());
    case Form::kLag:
      return Logarithmic(kShortLag, kLongLag);
    case Form::kPlay:
      return Logarithmic(kFine * range.Length(), kWide * range.Length());
    default:
      return {};
  }
  if (!IsProposed(form, variable, range)) return {};
  return grid;
}

double Rounded(double number) {
  return std::strtod(fmt::format("{:.6g}", number).c_str(), nullptr);
}

bool IsProposed(Form form, const std::string& variable, const diagnosis::Range& range) {
  const bool is_gap = variable.starts_with("gap of ");
  const bool is_position = variable.size() == 1 || variable.starts_with("pivot_");
  switch (form) {
    case Form::kAbsolute:  // of what has one sign it is itself
      return range.first < 0.0 && range.last > 0.0;
    case Form::kDecay:
      return IsTimeLike(variable);
    case Form::kLag:
      return variable.starts_with("warming of ");
    case Form::kPlay:
      return is_position;
    case Form::kLinear:
    case Form::kSquare:  // of a probe over its own gap: its gain, its characteristic
      return !is_gap;
    default:
      return true;
  }
}

}  // namespace abbe::learned
