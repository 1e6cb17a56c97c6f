// A proposal of what a stage may do: one atom, or a product of two, at a channel.
//
//   const Proposal proposal{channel, {{Atom::Form::kStep, "x", {31.4}}}};
//   proposal.expression().Text();                  // "step(x - 31.4)"
//
// A wave is one atom: its sine stands for both, the expression has its cosine as a second term.
// Units: those of simulation/learned/expression.h. Failure: none. Source: docs/theory-diagnosis.md.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/structure.h"
#include "simulation/learned/expression.h"
#include "simulation/stage_channel.h"

namespace abbe::learned {

using simulation::Atom;
using simulation::StageChannel;

struct Proposal {
  StageChannel channel;
  simulation::Product atoms;

  simulation::Expression expression() const;
  std::size_t columns() const;  // 1, of a wave 2
};

// Forms of one variable that are proposed, but for the sign.
const std::vector<Atom::Form>& Forms();
// How many of the numbers of a form are looked for: none or one.
bool HasNumber(Atom::Form form);

// The numbers that are tried of a form over the range of a variable, and how probable each is
// before any data: even in v0, in 1/P, in the logarithm of tau and w.
struct NumberGrid {
  std::vector<double> numbers;
  bool in_logarithm = false;
  double length = 0.0;  // of the prior range, of ln where in the logarithm
};
// `range` in the unit of the variable. Empty: the form has no number, or none fits.
NumberGrid GridOf(Atom::Form form, const std::string& variable, const diagnosis::Range& range);

// To six digits, as a text shows it.
double Rounded(double number);

// Whether a form of that variable says anything: a square of a warmth does, a decay of x does not.
bool IsProposed(Atom::Form form, const std::string& variable, const diagnosis::Range& range);

}  // namespace abbe::learned
