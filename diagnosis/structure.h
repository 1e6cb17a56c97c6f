// Structure: a dependence of one channel on one recorded variable, without a cause.
//
//   const Structure structure{channel, "feed", range};
//   structure.ColumnsOf(trace);       // one disturbance of the channel's stage for each term
//
// A channel is one stage of the simulation (simulation/stage_channel.h). Forms, of a variable v
// over its range:
//   smooth     cosines cos(pi k (v - first) / length), `terms` of them from k = 1
//   line       sine and cosine of `wave` times v
//   interval   1 from `from` to `to`, 0 elsewhere
//   product    of two variables "x*y": products of their Legendre polynomials of degree 1 and 2
// Variables (simulation/variables.h) with a factor, as the direction of motion, have it in each
// term, and begin with k = 0. What a cause does is left out: of an axis or a pivot over its own
// direction k = 0 (lost motion that is the same everywhere), of an axis over its own speed what
// changes sign with it (a lag), of a probe over its own gap the line and the square (a gain, a
// characteristic), with Legendre polynomials in place of cosines. Units: SI. Used to test what is
// left (structure_search.h) and to let something that is in no catalogue compete with the causes
// (something_else.h).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/scan.h"
#include "estimation/parameter.h"
#include "simulation/causes/cause.h"
#include "simulation/stage_channel.h"

namespace abbe::diagnosis {

using simulation::ChannelsOf;
using simulation::Instrument;
using simulation::InstrumentOf;
using simulation::kFeltAtRim;
using simulation::kFeltByLinkage;
using simulation::kFeltByProbes;
using simulation::StageChannel;

struct Range {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();

  double Length() const { return last - first; }
  // -1 to 1 over the range, and as at its ends beyond.
  Eigen::ArrayXd Scaled(const Eigen::RowVectorXd& values) const;
};
// One that may depend on the variable: a probe on its own gap alone. Empty where that does not
// change.
std::optional<Range> RangeOf(const std::string& variable, const StageChannel& channel,
                             const simulation::Scene& scene);

// The two variables of "x*y".
struct Factors {
  std::string first, second;
};
Factors FactorsOf(const std::string& product);

struct Structure {
  enum class Form { kSmooth, kLine, kInterval, kProduct };

  StageChannel channel;
  std::string variable;
  Range range;
  Form form = Form::kSmooth;
  Eigen::Index terms = 8, from = 1, step = 1;  // of a smooth one: k = from, from + step, ...
  bool is_rough = false;  // of a smooth one: terms of weight 1/k, as a random walk has them
  double wave = 0.0;      // rad per unit of the variable
  Interval interval = {};
  Range second = {};  // of the other variable of a product

  Eigen::Index columns() const;
  // What the coefficient of each term is multiplied by.
  Eigen::VectorXd Weights() const;
  // Whether an axis or a pivot depends on its own motion.
  bool IsOfItself() const;
  // The number of those of which it was chosen as the strongest.
  double among() const;
  // One row for each term, the same for all channels; no rows: the run lacks the variable.
  Eigen::MatrixXd FunctionsOf(const simulation::Trace& trace) const;
  std::vector<simulation::Disturbance> ColumnsOf(const simulation::Trace& trace) const;

 private:
  Eigen::MatrixXd ProductsOf(const simulation::Trace& trace) const;
  Eigen::MatrixXd SmoothOf(const simulation::Trace& trace, const Eigen::RowVectorXd& values) const;
};

// A smooth function of one variable, without what causes do.
Structure SmoothIn(const StageChannel& channel, const std::string& variable, const Range& range);

}  // namespace abbe::diagnosis
