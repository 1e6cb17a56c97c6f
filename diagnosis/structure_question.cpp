#include "diagnosis/structure_question.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "standards/chi_squared.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Trace;

constexpr double kAbsorbed = 1e-4;  // of the most information: what is left is rounding
// Standard deviations that coefficients may have, m or rad.
constexpr SizeRange kSizes{1e-9, 1e-3, 1.25};

// Natural logarithm of the probability of so much by chance.
double LogChance(double chi_square, int freedom) {
  if (freedom == 0) return 0.0;
  const double one = standards::ChiSquaredExceeds(chi_square, freedom);
  return one > 0.0 ? std::log(one) : -0.5 * chi_square;
}

// Lines and intervals are each channel's own.
bool MayBeShared(const Structure& structure) {
  using Form = Structure::Form;
  return structure.form != Form::kLine && structure.form != Form::kInterval;
}

}  // namespace

Found Explained(Structure structure, const Fit::Projection& projection) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(projection.information);
  const double most = eigen.eigenvalues().maxCoeff();
  Found found{.structure = std::move(structure)};
  VectorXd coefficients = VectorXd::Zero(projection.score.size());
  for (Index i = 0; i < coefficients.size(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * most) || value <= 0.0) continue;
    const double along = eigen.eigenvectors().col(i).dot(projection.score);
    found.chi_square += along * along / value;
    coefficients += along / value * eigen.eigenvectors().col(i);
    ++found.freedom;
  }
  found.length = coefficients.cwiseProduct(found.structure.Weights()).norm();
  if (!found.structure.channel.IsPlausible(found.length)) {
    found.chi_square = 0.0;
    found.freedom = 0;
    return found;
  }
  const double among = std::log(found.structure.among());
  found.log_probability = std::min(0.0, LogChance(found.chi_square, found.freedom) + among);
  found.drawn = SizeOfDraws(projection, kSizes, 0.0);
  found.drawn.log_evidence -= among;
  return found;
}

std::vector<Found> StructureQuestions::Ask(const std::vector<Structure>& structures) {
  std::vector<Index> groups;
  groups.reserve(structures.size());
  Index columns = 0;
  for (const Structure& structure : structures) {
    groups.push_back(structure.columns());
    columns += groups.back();
  }
  const StageChannel& channel = structures.front().channel;
  std::vector<MatrixXd> functions(fit_.runs());
  for (std::size_t run = 0; run < fit_.runs(); ++run) {
    const Trace& trace = fit_.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    functions[run] = MatrixXd::Zero(columns, trace.rows());
    Index first = 0;
    for (std::size_t s = 0; s < structures.size(); ++s) {
      MatrixXd made;
      const MatrixXd& own = MayBeShared(structures[s]) ? SharedFunctions(run, structures[s])
                                                       : (made = structures[s].FunctionsOf(trace));
      if (own.rows() > 0) functions[run].middleRows(first, own.rows()) = own;
      first += groups[s];
    }
  }
  const auto projections = fit_.ProjectInStage(channel.stage, functions, groups);
  std::vector<Found> found;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    found.push_back(Explained(structures[s], projections[s]));
  }
  return found;
}

// No rows: the run does not have the variable.
const MatrixXd& StructureQuestions::SharedFunctions(std::size_t run, const Structure& structure) {
  const Key key{run,
                structure.variable,
                structure.range.first,
                structure.range.last,
                structure.second.first,
                structure.second.last,
                structure.terms,
                structure.from,
                structure.is_rough};
  if (const MatrixXd* known = Known(key)) return *known;
  MatrixXd functions = structure.FunctionsOf(fit_.TraceOf(run));
  const std::lock_guard lock(mutex_);
  return known_.try_emplace(key, std::move(functions)).first->second;
}

const MatrixXd* StructureQuestions::Known(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(key);
  return found == known_.end() ? nullptr : &found->second;
}

Found Asked(const Fit& fit, const Structure& structure) {
  return StructureQuestions(fit).Ask({structure}).front();
}

}  // namespace abbe::diagnosis
