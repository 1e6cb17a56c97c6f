// Parameters of an estimation: names, nominal values, priors, estimates and uncertainties, shared
// by calibration, fusion, diagnosis, files and reports.
//
// A block holds a few parameters of one kind and unit: the lengths of the links, the coefficients
// of one error function, the offsets of one run. A parameter is addressed by its full name
// "block.entry", never by a position in a mask.
//
//   ParameterBlock links{"link",
//                        {"mm", 1e-3},
//                        {{"length_1", 0.200, 50e-6}, {"length_2", 0.180, 50e-6}}};
//   links["length_2"].held = true;      // keeps its value, is not estimated
//   links.Values();                     // [0.200 0.180], m
//
// Units: SI (or any one coherent set; estimation/ knows no metrology). `unit` is for printing only.
// Shapes: Values() n x 1, in the order of the entries.
// Failure: InputError for a name that is not in the block; the message lists the names that are. A
// prior is the knowledge before the data: a normal distribution around `nominal`.
// Validity: names are unique within a problem; a block may be copied, a copy is another block.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "failure/failure.h"

namespace abbe::estimation {

inline constexpr double kNoPrior = std::numeric_limits<double>::infinity();
inline constexpr double kNoTolerance = std::numeric_limits<double>::infinity();

// The unit in which a number in SI is printed: printed = SI / si.
struct PrintUnit {
  std::string name;  // empty: a plain number
  double si = 1.0;
};
inline const PrintUnit kMicrometres{"um", 1e-6}, kMicroradians{"urad", 1e-6};

struct Parameter {
  std::string name;
  double nominal = 0.0;
  double prior_sd = kNoPrior;  // standard deviation of the prior around `nominal`
  double value = nominal;      // the start before a solve, the estimate after it
  // Standard uncertainty of `value` after a solve; infinite where the data and the prior do not
  // determine it, 0 where it is held, NaN before.
  double uncertainty = std::numeric_limits<double>::quiet_NaN();
  // The largest error of this parameter that does not matter. Without a prior it decides when a
  // direction counts as weak (weak_directions.h). It has no influence on the estimate.
  double tolerance = kNoTolerance;
  bool held = false;
};

struct ParameterBlock {
  ParameterBlock(std::string block_name, PrintUnit print_unit, std::vector<Parameter> parameters)
      : name(std::move(block_name)), unit(std::move(print_unit)), entries(std::move(parameters)) {}

  std::string name;
  PrintUnit unit;
  std::vector<Parameter> entries;

  Eigen::Index size() const { return entries.size(); }

  Parameter& operator[](std::string_view entry) { return entries[Find(entry)]; }
  const Parameter& operator[](std::string_view entry) const { return entries[Find(entry)]; }

  // "link.length_1".
  std::string FullName(std::size_t entry) const { return name + "." + entries[entry].name; }

  // All entries.
  void Hold(bool held = true) {
    for (Parameter& entry : entries) entry.held = held;
  }
  // All entries.
  void Free() { Hold(false); }

  // In SI.
  Eigen::VectorXd Values() const {
    Eigen::VectorXd values(size());
    for (Eigen::Index i = 0; i < size(); ++i) values[i] = entries[i].value;
    return values;
  }

  // With a prior of `prior_sd` around 0 each, held there where it is 0.
  static ParameterBlock AroundZero(std::string name, PrintUnit unit,
                                   const std::vector<std::string>& entries, double prior_sd) {
    const bool held = prior_sd == 0.0;
    ParameterBlock block(std::move(name), std::move(unit), {});
    for (const std::string& entry : entries) {
      block.entries.push_back(
          {.name = entry, .prior_sd = held ? kNoPrior : prior_sd, .held = held});
    }
    return block;
  }

 private:
  std::size_t Find(std::string_view entry) const {
    std::string known;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].name == entry) return i;
      known += (i == 0 ? "" : ", ") + entries[i].name;
    }
    throw InputError(
        fmt::format("block '{}' has no parameter '{}'; it has {}", name, entry, known));
  }
};

}  // namespace abbe::estimation
