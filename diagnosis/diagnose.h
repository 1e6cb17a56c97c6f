// The diagnosis: which causes the simulation lacks, which rivals the data cannot tell apart, what
// these runs cannot show, and what is left unexplained.
//
//   const Diagnosis diagnosis = Diagnose(campaign);
//   diagnosis.verdict;                      // Verdict::kExplained
//   diagnosis.findings[0].score.candidate.Name();          // "backlash:X"
//
// How: search.h. Where something is left, noise with a memory is a hypothesis of its own: the runs
// whose rows go on from one to the next are whitened so, the search is repeated, and what is more
// probable is told (noise_hypothesis.h).
// Verdict: clean, nothing found, nothing left; explained, each finding is at least kCertain among
// its rivals and nothing is left; ambiguous, rivals; unexplained, structure is left.
// Source: MacKay, Neural Computation 4 (1992), for evidence and Occam factor. Units: SI. Failure:
// that of Fit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/unexplained.h"
#include "diagnosis/where_it_shows.h"
#include "simulation/doubt.h"

namespace abbe::diagnosis {

inline constexpr double kCertain = simulation::kCertain;  // 0.99
inline constexpr double kPresent = 0.1;  // probability that a machine has a cause at all
// No finding is more probable where structure is left that no cause explains: what makes it may
// make the finding too.
inline constexpr double kBesideUnexplained = 0.9;
inline constexpr double kShowable = 5.0;  // standard deviations of a plausible size

enum class Verdict { kClean, kExplained, kAmbiguous, kUnexplained };
std::string_view Name(Verdict verdict);

struct Rival {
  Candidate candidate;
  double probability = 0.0;
  Eigen::VectorXd coefficients = {};  // if it were the one
};

// The run that would tell a finding from its rivals (next_run.h).
struct NextRun {
  std::string text;                   // what to do
  double expected_probability = 0.0;  // of the right one then
  double seconds = 0.0;               // that it takes
};

struct Finding {
  Score score;
  double probability = 0.0;   // among all that could stand in its place
  std::vector<Rival> rivals;  // others above 1 %
  // Probability of something outside the catalogue in its place; 0 below 1 %.
  double something_else = 0.0;
  std::vector<std::string> doubts = {};  // doubts.h
  std::optional<NextRun> next_run = {};
  Curve curve = {};
};
// Not so: readings that are none, which were left out.
bool IsModelled(const Finding& finding);

struct Diagnosis {
  Verdict verdict = Verdict::kClean;
  std::vector<Finding> findings;
  std::vector<std::string> cannot_show;  // "probe-position:probe_a"
  std::vector<Score> evidence;           // of the first round: best shape of each name
  std::vector<Leftover> leftovers;
  std::vector<std::string> notes;            // what was found of the noise
  double chi_before = 0.0, chi_after = 0.0;  // chi-square per row of all runs
  double map_change = 0.0;    // m: of the volumetric error at most, by what was found
  estimation::Result fitted;  // with all that was found
};

Diagnosis Diagnose(const Campaign& campaign);

}  // namespace abbe::diagnosis
