// What a solve found: values, their full covariance, and how far both can be believed.
//
//   const Result result = problem.Solve();
//   if (!result.Usable()) throw NumericalError(result.WhyNotUsable());
//   result.Value("link.length_1");  result.Uncertainty("link.length_1");        // SI
//   result.Covariance("link", "base");                                           // block x block
//   fmt::print("{}", result.Report());
//
// chi-square of a source: sum of (r / sigma)^2 at the solution, a row of a robust source counted
// with its weight. Its redundancy: rows minus the parameters that these rows determine, tr(C J'J);
// the redundancies of all sources add up to rows - parameters, and chi-square / redundancy is near
// 1 for each source whose deviations were stated truly. Covariance: (J'J)^-1 with the priors in J
// and the stated deviations believed; it is not multiplied by chi-square / redundancy. Where a
// direction is seen by neither data nor prior, every parameter that takes part has uncertainty
// infinite and its covariances are NaN: nothing is silently regularised. Where only the prior holds
// a direction, its uncertainty is the prior's, and `weak_directions` says so. Held parameters have
// 0. Failure: InputError from a name that is not there.
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
  // Rows beyond kOutlierAt deviations, the worst kMostOutliers of them, worst first.
  std::vector<Outlier> outliers;
  Eigen::Index outlier_count = 0;
};

inline constexpr std::string_view kPriorSource = "prior";  // the parameters' own priors
inline constexpr double kOutlierAt = 4.0;
inline constexpr std::size_t kMostOutliers = 1000;

// Who determined a parameter.
enum class SeenBy {
  kHeld,     // nobody, it was not estimated
  kData,     // the data at least halved its prior variance, or there is no prior
  kPrior,    // mostly the prior
  kNothing,  // nothing: it is part of a direction without data or prior, or beyond its tolerance
};
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
  // Of the Jacobian of the data, columns scaled to length 1; infinite when rounding hides the
  // smallest.
  double condition = 0.0;
  double chi_square = 0.0;   // of all sources
  Eigen::Index rows = 0;     // of all sources, priors included
  Eigen::Index freedom = 0;  // rows - determined parameters
  double redundancy = 0.0;   // of the data
  int iterations = 0;

  bool Usable() const { return status == Status::kConverged; }
  // One line; empty when usable.
  std::string WhyNotUsable() const;

  const ParameterBlock& Block(std::string_view block) const;
  double Value(std::string_view full_name) const;
  double Uncertainty(std::string_view full_name) const;
  SeenBy Seen(std::string_view full_name) const;
  const SourceResult& Source(std::string_view source) const;
  // Entries of block a by entries of block b, held ones included.
  Eigen::MatrixXd Covariance(std::string_view block_a, std::string_view block_b) const;
  double Correlation(std::string_view full_name_a, std::string_view full_name_b) const;

  // The fit in words: redundancy, chi-square of each source, parameters, weak directions.
  std::string Report(std::size_t most_parameters = 60) const;
};

}  // namespace abbe::estimation
