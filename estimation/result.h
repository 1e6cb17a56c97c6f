// The result of a solve: estimates, their full covariance, and the tests of both.
//
//   const Result result = problem.Solve();
//   if (!result.Usable()) throw NumericalError(result.WhyNotUsable());
//   result.Value("link.length_1");  result.Uncertainty("link.length_1");        // SI
//   result.Covariance("link", "base");                                           // block x block
//   fmt::print("{}", result.Report());
//
// Chi-square of a source: sum of (r / sigma)^2 at the solution, with the weights of a robust loss.
// Redundancy of a source: its rows minus the parameters that they determine, tr(C J'J); the
// redundancies of all sources add up to rows - parameters, and chi-square / redundancy is near 1
// for a source whose stated standard deviations are right. Covariance: C = (J'J)^-1 with the priors
// among the rows of J and the standard deviations as stated; it is not multiplied by chi-square /
// redundancy. Where neither data nor prior determine a direction, every parameter in it has an
// infinite uncertainty and NaN covariances: nothing is silently regularised. Where only the prior
// determines a direction, its uncertainty is the prior's, and `weak_directions` lists it. Held
// parameters have uncertainty 0.
// Units: SI. Shapes: covariance n x n of the free parameters; Covariance() entries of a by entries
// of b.
// Failure: InputError for a name that the result does not have.
// Source: Gauss-Markov; redundancy: Baarda, A testing procedure for use in geodetic networks
// (1968).
// Validity: first order at the solution.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/weak_directions.h"

namespace abbe::estimation {

struct Outlier {
  Eigen::Index row;   // within its source, in the order of adding
  double normalised;  // r / sigma
};

struct SourceResult {
  std::string name;
  bool is_prior = false;
  Eigen::Index rows = 0;
  double redundancy = 0.0;
  double chi_square = 0.0;
  double rms = 0.0;  // of r / sigma
  // Rows with |r / sigma| > kOutlierAt, at most kMostOutliers of them, largest first.
  std::vector<Outlier> outliers;
  Eigen::Index outlier_count = 0;
};

inline constexpr std::string_view kPriorSource = "prior";  // the parameters' own priors
inline constexpr double kOutlierAt = 4.0;
inline constexpr std::size_t kMostOutliers = 1000;

// What determines a parameter.
enum class SeenBy {
  kHeld,     // it was not estimated
  kData,     // the data: they at least halve its prior variance, or it has no prior
  kPrior,    // mostly the prior
  kNothing,  // it is part of an undetermined direction, or its uncertainty exceeds its tolerance
};
// "held", "data", "prior" or "nothing".
std::string_view Name(SeenBy seen);

struct Result {
  enum class Status { kNotRun, kConverged, kUndetermined };
  Status status = Status::kNotRun;

  std::vector<ParameterBlock> blocks;  // value and uncertainty filled in
  std::vector<std::string> names;      // of the free parameters, in the order of `covariance`
  Eigen::MatrixXd covariance;
  std::vector<SeenBy> seen_by;        // of the free parameters
  std::vector<SourceResult> sources;  // in the order of adding, "prior" last where there are any
  std::vector<WeakDirection> weak_directions;
  // Condition number of the Jacobian of the data, columns scaled to length 1; infinite when
  // rounding hides the smallest singular value.
  double condition = 0.0;
  double chi_square = 0.0;   // of all sources
  Eigen::Index rows = 0;     // of all sources, priors included
  Eigen::Index freedom = 0;  // rows - determined parameters
  double redundancy = 0.0;   // of the data
  int iterations = 0;

  // Converged, and every parameter determined.
  bool Usable() const { return status == Status::kConverged; }
  // The reason in one line; empty when usable.
  std::string WhyNotUsable() const;

  // With values and uncertainties.
  const ParameterBlock& Block(std::string_view block) const;
  // In SI.
  double Value(std::string_view full_name) const;
  // Standard, in SI; infinite where nothing determines it.
  double Uncertainty(std::string_view full_name) const;
  // What determines the parameter.
  SeenBy Seen(std::string_view full_name) const;
  // By its name.
  const SourceResult& Source(std::string_view source) const;
  // Entries of block a by entries of block b, held ones included.
  Eigen::MatrixXd Covariance(std::string_view block_a, std::string_view block_b) const;
  // -1 ... 1.
  double Correlation(std::string_view full_name_a, std::string_view full_name_b) const;

  // Text report: redundancy, chi-square of each source, parameters, weak directions.
  std::string Report(std::size_t most_parameters = 60) const;
};

}  // namespace abbe::estimation
