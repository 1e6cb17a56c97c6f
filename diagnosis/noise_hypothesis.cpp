#include "diagnosis/noise_hypothesis.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "diagnosis/search.h"
#include "simulation/remembered_noise.h"

namespace abbe::diagnosis {
namespace {

constexpr double kShown = 10.0;       // logarithm of the likelihood
constexpr double kMostSteps = 40.0;   // rows, of a memory
constexpr double kFewestRows = 60.0;  // of a run that tells
constexpr double kPerName = 100.0;    // candidates, about
// Logarithms of the prior probability: of a memory in a run, of something that was taken in.
const double kPriorOfMemory = std::log(kElse), kPriorOfMember = std::log(kPresent / kPerName);

std::optional<estimation::NoiseMemory> MemoryOf(const Fit& fit, std::size_t r) {
  const PreparedRun& run = fit.campaign().runs()[r];
  const auto& left = fit.LeftOf(r);
  const double rows = run.trace.rows();
  if (run.trace.head || run.trace.rim || run.memory || !run.simulated.response ||
      rows < kFewestRows || left.size() % run.trace.rows() != 0) {
    return {};
  }
  const auto found = estimation::FitMemory(simulation::ChannelsOf(left, run.trace.time));
  if (found.gain < kShown || found.noise.time > kMostSteps * found.step) return {};
  return found.noise;
}

// Logarithm of the marginal likelihood with the prior of what was taken in, up to a constant.
double Worth(const Search& search) {
  double worth = search.fit().log_likelihood();
  for (const PreparedRun& run : search.fit().campaign().runs()) {
    if (!run.memory) continue;
    const auto& times = run.trace.time;
    const double values = run.simulated.residual->Rows();
    const double channels = values / times.size();
    const estimation::MemoryFilter filter(times, *run.memory);
    worth += kPriorOfMemory - 0.5 * channels * filter.log_determinant();
  }
  return worth + kPriorOfMember * search.fit().taken_in().size();
}

std::string NoteOf(const PreparedRun& run, const estimation::NoiseMemory& noise) {
  const double share = std::pow(noise.slow / noise.sd(), 2);
  return fmt::format(
      "{}: what is left goes on from one row to the next: {:.0f} % of its variance fades within "
      "{:.2g} s, and counts as so many fewer rows",
      run.simulated.name, 100.0 * share, noise.time);
}

}  // namespace

Diagnosis BesideMemory(const Campaign& given) {
  const auto own = std::make_shared<const Campaign>(given);
  const Campaign& campaign = *own;
  Search white(campaign);
  Diagnosis diagnosis = white.Run();
  diagnosis.campaign = own;
  if (diagnosis.verdict != Verdict::kUnexplained) return diagnosis;
  const auto other_noise = std::make_shared<Campaign>(campaign);
  Campaign& remembering = *other_noise;
  std::vector<std::string> notes;
  for (std::size_t run = 0; run < campaign.runs().size(); ++run) {
    // What structures explain was no memory.
    if (!MemoryOf(white.fit(), run)) continue;
    const auto memory = MemoryOf(white.base(), run);
    if (!memory) continue;
    notes.push_back(NoteOf(campaign.runs()[run], *memory));
    remembering.SetMemory(run, *memory);
  }
  if (notes.empty()) return diagnosis;
  Search again(remembering);
  Diagnosis other = again.Run();
  if (Worth(again) < Worth(white)) return diagnosis;
  other.notes = std::move(notes);
  other.campaign = other_noise;
  return other;
}

}  // namespace abbe::diagnosis
