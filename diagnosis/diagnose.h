// The diagnosis: which causes the simulation lacks, which rivals the data cannot tell apart, what
// these runs cannot show, and what is left unexplained.
//
//   const Diagnosis diagnosis = Diagnose(campaign);
//   diagnosis.verdict;                      // Verdict::kExplained
//   diagnosis.findings[0].score.candidate.Name();          // "backlash:X"
//
// How: search.h. Where structure is left, correlated noise is tried as a rival explanation: runs
// whose residuals go on from row to row are whitened for it, the search is repeated, and the more
// probable of both results is kept (noise_hypothesis.h). Verdict: `clean`: nothing found, nothing
// left. `explained`: each finding has at least the probability kCertain among its rivals, and
// nothing is left. `ambiguous`: a finding has rivals. `unexplained`: structure is left; `learned`:
// a term of no catalogue explains it (learned/). Shapes: coefficients as their cause has them; one
// evidence a cause and object.
// Source: MacKay, Neural Computation 4 (1992), for evidence and Occam factor.
// Units: SI.
// Failure: that of Fit.
// Validity: first order at the fit, noise as the runs themselves show it; a cause outside the
// catalogue shows as structure without a name.
#pragma once

#include <memory>
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
// The highest probability of a finding beside structure that no cause explains: the unknown origin
// of the structure may have made the finding too.
inline constexpr double kBesideUnexplained = 0.9;
inline constexpr double kShowable = 5.0;  // standard deviations of a plausible size

enum class Verdict { kClean, kExplained, kAmbiguous, kUnexplained, kLearned };
// "explained".
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
// False for invalid readings, which are left out instead.
bool IsModelled(const Finding& finding);

struct Diagnosis {
  Verdict verdict = Verdict::kClean;
  std::vector<Finding> findings;
  std::vector<std::string> cannot_show;  // "probe-position:probe_a"
  std::vector<Score> evidence;           // of the first round: best shape of each name
  std::vector<Leftover> leftovers;
  std::vector<std::string> notes;            // what was found of noise and errors
  double chi_before = 0.0, chi_after = 0.0;  // chi-square per row of all runs
  double map_change = 0.0;    // m: largest change of the volumetric error by the findings
  estimation::Result fitted;  // with all that was found
  // With the noise and the errors of the axes that were found, empty for an arm; and its fit
  // without causes where something is left.
  std::shared_ptr<const Campaign> campaign = {};
  std::shared_ptr<const Fit> base = {};
};

// The whole search.
Diagnosis Diagnose(const Campaign& campaign);

// What the diagnosis of `given` holds for, to hold it out and to plan further runs with.
const Campaign& CampaignOf(const Diagnosis& diagnosis, const Campaign& given);

}  // namespace abbe::diagnosis
