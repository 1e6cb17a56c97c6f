#include "investigate/worlds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "diagnosis/something_else.h"
#include "investigate/expected_information.h"
#include "settings/unit.h"
#include "simulation/stage_channel.h"
#include "simulation/variables.h"

namespace abbe::investigate {
namespace {

using diagnosis::Candidate;
using diagnosis::Diagnosis;
using Eigen::Index;
using Eigen::VectorXd;

VectorXd PlausibleOf(const Candidate& candidate) {
  return candidate.cause->IsBinary() ? VectorXd::Zero(1).eval() : candidate.Plausible();
}

// One of each name: with the shape that the diagnosis found best, else with the middle one.
std::vector<Candidate> OneOfEach(const simulation::Scene& scene, double coarseness,
                                 const Diagnosis* now) {
  std::map<std::string, Candidate> best;
  if (now != nullptr) {
    for (const diagnosis::Score& score : now->evidence) {
      best.emplace(score.candidate.Name(), score.candidate);
    }
  }
  const std::vector<Candidate> all = diagnosis::AllCandidates(scene, coarseness);
  std::vector<Candidate> one;
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].Name() == all[first].Name()) ++last;
    const auto known = best.find(all[first].Name());
    const bool has_shape = known != best.end() && known->second.shape.size() > 0;
    one.push_back(has_shape ? known->second : all[std::midpoint(first, last)]);
  }
  return one;
}

World OfCause(Candidate candidate, double probability) {
  World world{candidate.Name(), candidate.Name(), probability};
  const bool binary = candidate.cause->IsBinary();
  world.deviation = PlausibleOf(candidate);
  world.mean = VectorXd::Constant(world.deviation.size(), binary ? 1.0 : 0.0);
  world.candidate = std::make_shared<const Candidate>(std::move(candidate));
  return world;
}

// A wave of two thirds of the travel: too long for a window, too short for a bow.
std::string WaveText(const std::string& position, double travel_mm) {
  const double period = 2.0 / 3.0 * travel_mm;
  return fmt::format("sin(2 pi {0} / {1:.6g}) + cos(2 pi {0} / {1:.6g})", position, period);
}

// The expression of something unknown over a variable; empty: there is none for it.
std::string FormOver(const std::string& variable, const simulation::Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    if (variable == std::string(1, "xyz"[axis])) {
      return WaveText(variable, scene.travel[axis] / settings::kMillimetre);
    }
  }
  if (simulation::HasFactor(variable)) {
    return fmt::format("sign({})", simulation::OwnerOf(variable));
  }
  if (variable == "run" || !simulation::IsVariable(variable)) return {};
  return variable + "^2";
}

World OfUnknown(const std::string& object, const std::string& variable, const std::string& form,
                Worlds& worlds) {
  constexpr double kPlausible = 1e-6;  // m or rad
  simulation::LearnedTerm term;
  term.object = object;
  term.expression = simulation::ParseExpression(form);
  // Coefficients of a square have a unit of their own; what counts is that it shows.
  term.coefficients = VectorXd::Constant(term.expression.columns(), 0.1 * kPlausible);
  worlds.unknown.push_back(simulation::LearnedCause::Of(std::move(term)));
  const auto& cause = *worlds.unknown.back();
  World world = OfCause({&cause.cause(), cause.object(), {}}, 0.0);
  world.name = fmt::format("{} over {}", object, variable);
  world.group = kUnknown;
  return world;
}

// What is unknown, each as probable as the others.
void AddUnknown(const simulation::Scene& scene, double probability, Worlds& worlds) {
  const std::size_t first = worlds.list.size();
  for (const simulation::StageChannel& channel : simulation::ChannelsOf(scene)) {
    for (int axis = 0; axis < 3; ++axis) {
      // Over its own axis it is one of the 21 errors.
      const bool own =
          channel.stage < simulation::kToolStage && channel.stage / machine::kMotions == axis;
      if (own || !(scene.travel[axis] > 0.0)) continue;
      const std::string variable(1, "xyz"[axis]);
      worlds.list.push_back(OfUnknown(channel.object, variable, FormOver(variable, scene), worlds));
    }
  }
  for (std::size_t i = first; i < worlds.list.size(); ++i) {
    worlds.list[i].probability = probability / (worlds.list.size() - first);
  }
}

void AddNothing(double probability, Worlds& worlds) {
  worlds.list.push_back({kNothing, kNothing, probability});
}

void Normalize(std::vector<World>& list) {
  double sum = 0.0;
  for (const World& world : list) sum += world.probability;
  for (World& world : list) world.probability /= sum;
}

bool CanBeTold(const Candidate& candidate) {
  return candidate.cause->columns || candidate.cause->relaxes;
}

// The finding that is least certain, if one is uncertain.
const diagnosis::Finding* InDoubt(const Diagnosis& now) {
  const auto least = std::ranges::min_element(now.findings, {}, &diagnosis::Finding::probability);
  return least == now.findings.end() || least->probability >= diagnosis::kCertain ? nullptr
                                                                                  : &*least;
}

World OfEstimate(const Candidate& candidate, const VectorXd& coefficients,
                 const Eigen::MatrixXd& covariance, double probability) {
  World world = OfCause(candidate, probability);
  world.mean = coefficients;
  const Index count = coefficients.size();
  world.deviation = covariance.rows() >= count
                        ? covariance.diagonal().head(count).cwiseMax(0.0).cwiseSqrt().eval()
                        : VectorXd::Zero(count).eval();
  return world;
}

// One finding with its rivals; what is left of the probability goes to something unknown.
Worlds OfFinding(const diagnosis::Finding& finding, const simulation::Scene& scene) {
  Worlds worlds;
  AddNothing(0.0, worlds);
  const diagnosis::Score& score = finding.score;
  worlds.list.push_back(
      OfEstimate(score.candidate, score.coefficients, score.covariance, finding.probability));
  double sum = finding.probability;
  for (const diagnosis::Rival& rival : finding.rivals) {
    if (!CanBeTold(rival.candidate)) continue;
    worlds.list.push_back(OfEstimate(rival.candidate, rival.coefficients, {}, rival.probability));
    sum += rival.probability;
  }
  AddUnknown(scene, std::max(finding.something_else, 1.0 - sum), worlds);
  Normalize(worlds.list);
  return worlds;
}

// What is left depends on one of these variables, which are separate worlds; or it was an accident
// of the runs, and another run will not show it.
Worlds OfLeftovers(const Diagnosis& now, const simulation::Scene& scene) {
  constexpr double kAccident = 0.05;
  Worlds worlds;
  AddNothing(0.0, worlds);
  for (const diagnosis::Leftover& left : now.leftovers) {
    std::vector<diagnosis::Dependence> places{{left.variable, left.object}};
    places.insert(places.end(), left.one_of.begin(), left.one_of.end());
    for (const diagnosis::Dependence& place : places) {
      const std::string form = FormOver(place.variable, scene);
      if (form.empty() || !simulation::ChannelNamed(place.object)) continue;
      World world = OfUnknown(place.object, place.variable, form, worlds);
      world.group = world.name;
      world.probability = 1.0 / places.size();
      worlds.list.push_back(std::move(world));
    }
  }
  if (worlds.list.size() == 1) return worlds;
  Normalize(worlds.list);
  for (World& world : worlds.list) world.probability *= 1.0 - kAccident;
  worlds.list.front().probability = kAccident;
  return worlds;
}

}  // namespace

double EntropyOf(const std::vector<World>& worlds, const VectorXd& probabilities) {
  std::map<std::string_view, double> groups;
  for (std::size_t i = 0; i < worlds.size(); ++i) groups[worlds[i].group] += probabilities[i];
  double bits = 0.0;
  for (const auto& [name, probability] : groups) {
    if (probability > 0.0) bits -= probability * std::log2(probability);
  }
  return bits;
}

double Worlds::Entropy() const {
  VectorXd probabilities(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) probabilities[i] = list[i].probability;
  return EntropyOf(list, probabilities);
}

Worlds WorldsOf(const Diagnosis* now, const simulation::Scene& scene, double coarseness) {
  if (now != nullptr && !now->leftovers.empty()) return OfLeftovers(*now, scene);
  if (now != nullptr) {
    if (const diagnosis::Finding* finding = InDoubt(*now)) {
      Worlds worlds = OfFinding(*finding, scene);
      for (const diagnosis::Finding& other : now->findings) {
        if (&other != finding && CanBeTold(other.score.candidate) &&
            !other.score.candidate.cause->IsBinary()) {
          worlds.certain.push_back(other.score.candidate);
        }
      }
      return worlds;
    }
  }
  Worlds worlds;
  AddNothing(1.0 - diagnosis::kPresent - diagnosis::kElse, worlds);
  for (Candidate& candidate : OneOfEach(scene, coarseness, now)) {
    if (CanBeTold(candidate)) worlds.list.push_back(OfCause(std::move(candidate), 0.0));
  }
  for (std::size_t i = 1; i < worlds.list.size(); ++i) {
    worlds.list[i].probability = diagnosis::kPresent / (worlds.list.size() - 1);
  }
  AddUnknown(scene, diagnosis::kElse, worlds);
  return worlds;
}

void WeighBySilence(const Diagnosis* now, const Eigen::MatrixXd& S, Worlds& worlds) {
  if (now == nullptr || !now->findings.empty() || !now->leftovers.empty()) return;
  std::map<std::string, double> evidence;
  for (const diagnosis::Score& score : now->evidence) {
    evidence.emplace(score.candidate.Name(), score.log_evidence);
  }
  const VectorXd silent = ExpectedEvidence(S, worlds.list, VectorXd::Zero(S.rows()));
  for (std::size_t i = 1; i < worlds.list.size(); ++i) {
    World& world = worlds.list[i];
    const auto known = evidence.find(world.name);
    world.probability *= std::exp(known != evidence.end() ? known->second : silent[i]);
  }
  Normalize(worlds.list);
}

}  // namespace abbe::investigate
