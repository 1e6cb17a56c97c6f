// What a diagnosis found, as a file that every other command takes: the causes that the simulation
// of a machine lacked, with their sizes. A person may edit it; a table that is deleted is a cause
// that is gone. docs/extended-model.md describes the keys.
//
//   const ExtendedModel model = ReadExtendedModel("mill.causes.toml", {"demo-mill", true, 3});
//   Correct(recording, model.causes, model.origin, instruments);  // simulation/kinds.h
//
// What the diagnosis was not sure of stands there too; simulation/doubt.h says what follows of it.
//
// Units: values and deviations SI, in the order of the cause's keys. Shapes: covariance and u95 as
// the coefficients and the keys of the cause.
// Failure: InputError with file, line and key for an unknown cause, object or key, a missing key, a
// number that is not finite or beyond what is plausible, the model of another machine, a file that
// is no extended model.
// Source: own format; docs/extended-model.md.
// Validity: for the machine that it names; causes are those that this version knows.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "simulation/causes/cause.h"
#include "simulation/learned/learned_term.h"
#include "simulation/trace.h"

namespace abbe::simulation {

struct ModelledCause {
  const Cause* cause;
  Object object;
  Eigen::VectorXd values;                // of the keys
  Eigen::VectorXd u95;                   // of the values; empty: not stated
  Eigen::MatrixXd covariance;            // of the coefficients; empty: not stated
  double probability = 1.0;              // among its rivals
  std::vector<std::string> rivals = {};  // "cap-friction:cap", the most probable first
  // A learned term owns its cause; null: one of the catalogue.
  std::shared_ptr<const LearnedCause> learned = {};

  std::string Name() const;  // "backlash:X", "thermal-growth:X (temp_table_c)"
};

struct ModelSource {
  std::string file, sha256;
};

// Root mean squares of measured minus simulated, in units of the stated noise.
struct ModelGain {
  Eigen::Index heldout_rows = 0;  // 0: nothing was held out
  double heldout_before = 0.0, heldout_after = 0.0;
  double fitted_before = 0.0, fitted_after = 0.0;
};

// What no known cause explains (diagnosis/unexplained.h).
struct Unexplained {
  std::string object, variable;  // "probe_a", "time"
  double amplitude = 0.0;        // rms, in `unit`
  std::string unit;              // "um", "urad", "times the noise"
  // m: what it moves a measured point by, rms; empty: nobody knows.
  std::optional<double> in_space = {};
};

// As it is used.
ModelledCause ModelledTerm(LearnedTerm term);

inline constexpr const char *kVerdictUnexplained = "unexplained", *kVerdictLearned = "learned";

struct ExtendedModel {
  std::string machine;
  std::string verdict = {};  // of the diagnosis; empty: not stated
  std::vector<Unexplained> unexplained = {};
  std::vector<std::string> next_runs = {};  // that would tell causes from their rivals
  Origin origin;                            // from when on time counts, and how warm it was
  ModelGain gain;
  std::vector<ModelSource> sources;
  std::vector<ModelledCause> causes;
};

// What a machine offers as objects of causes.
struct CauseObjects {
  std::string machine;
  bool head = true;
  Eigen::Index pivots = 0;
};

// `objects`: what the machine file has.
ExtendedModel ReadExtendedModel(const std::filesystem::path& path, const CauseObjects& objects);
// The whole file.
std::string ExtendedModelText(const ExtendedModel& model);

}  // namespace abbe::simulation
