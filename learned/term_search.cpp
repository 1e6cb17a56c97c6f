#include "learned/term_search.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "diagnosis/something_else.h"
#include "diagnosis/structure_refinement.h"
#include "learned/number_posterior.h"
#include "simulation/variables.h"

namespace abbe::learned {
namespace {

using diagnosis::Fit;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Form = Atom::Form;

constexpr std::size_t kMultiplied = 20, kRefined = 8;
constexpr diagnosis::SizeRange kSizes{1e-9, 1e-3, 1.25};  // m or rad
constexpr double kHidden = 1e-6;
constexpr double kWorthAWord = 15.0;  // chi-square

bool IsSum(const std::string& variable) {
  return variable.size() == 3 && (variable[1] == '+' || variable[1] == '-');
}

// The number of atoms in a proposal; a sum of two positions counts twice.
double LengthOf(const Proposal& proposal) {
  double length = 0.0;
  for (const Atom& atom : proposal.atoms) length += IsSum(atom.variable) ? 2.0 : 1.0;
  return length;
}

// The rank before sizes and numbers are averaged over.
double QuickWorth(const Rated& rated, double atoms) {
  double worth = 0.5 * rated.chi_square - LengthOf(rated.proposal) * std::log(atoms);
  for (const Atom& atom : rated.proposal.atoms) {
    if (HasNumber(atom.form)) worth -= std::log(static_cast<double>(kParts));
  }
  return worth;
}

bool IsSame(const Rated& a, const Rated& b) {
  const auto& one = a.proposal;
  const auto& other = b.proposal;
  return one.channel.object == other.channel.object &&
         std::ranges::equal(one.atoms, other.atoms, [](const Atom& x, const Atom& y) {
           return x.form == y.form && x.variable == y.variable;
         });
}

// Among stages that do the same to all runs the one a metrologist would name comes first: over the
// position of another axis its straightness, EYX over x; else the axis itself; the ball last.
int Rank(const Rated& rated) {
  const std::string& object = rated.proposal.channel.object;
  const std::string& variable = rated.proposal.atoms.front().variable;
  if (object.starts_with("ball_")) return 0;
  if (object.size() == 1) return 2;
  const auto axis = static_cast<char>(std::tolower(object.back()));
  return object.size() == 3 && variable == std::string(1, axis) ? 3 : 1;
}

// Whether two stages do the same to the data with the same atoms.
bool IsAsGood(const Rated& a, const Rated& b) {
  constexpr double kSame = 1e-3;
  return std::abs(a.chi_square - b.chi_square) < kSame * b.chi_square &&
         std::ranges::equal(a.proposal.atoms, b.proposal.atoms, [](const Atom& x, const Atom& y) {
           return x.form == y.form && x.variable == y.variable;
         });
}

bool HasForms(const Rated& a, const Rated& b) {
  return std::ranges::equal(a.proposal.atoms, b.proposal.atoms, {}, &Atom::form, &Atom::form);
}

// `each_form`: only the best of each.
void KeepBest(std::vector<Rated>& all, std::size_t count, double atoms, bool each_form = false) {
  std::ranges::stable_sort(all, std::greater(),
                           [&](const Rated& rated) { return QuickWorth(rated, atoms); });
  std::vector<Rated> kept;
  for (Rated& rated : all) {
    if (kept.size() == count) break;
    if (each_form &&
        std::ranges::any_of(kept, [&](const Rated& k) { return HasForms(k, rated); })) {
      continue;
    }
    const auto known = std::ranges::find_if(
        kept, [&](const Rated& other) { return IsSame(other, rated) || IsAsGood(other, rated); });
    if (known == kept.end()) {
      kept.push_back(std::move(rated));
      continue;
    }
    if (IsSame(*known, rated)) continue;
    std::vector<std::string> alike = std::move(known->alike);
    const bool better = Rank(rated) > Rank(*known);
    alike.push_back((better ? *known : rated).proposal.channel.object);
    if (better) *known = std::move(rated);
    known->alike = std::move(alike);
  }
  all = std::move(kept);
}

// Over parts, each form of each scan at its best.
void AddOfParts(const std::vector<PartScan>& scans, std::vector<Rated>& all) {
  for (const PartScan& scan : scans) {
    const Atom sign{Form::kSign, scan.variable};
    const auto add = [&](const Atom& atom, double chi_square) {
      if (chi_square < kWorthAWord) return;
      Rated rated{{scan.channel, {atom}}, chi_square};
      if (scan.by_direction && atom.form != Form::kSign) rated.proposal.atoms.push_back(sign);
      all.push_back(std::move(rated));
    };
    if (scan.by_direction && scan.hats) {
      const double information = scan.S.sum(), score = scan.g.sum();
      if (information > 0.0) add(sign, score * score / information);
    }
    for (const Form form : Forms()) {
      const Asked best = BestOf(scan, form);
      if (best.chi_square > 0.0) add(best.atom, best.chi_square);
    }
  }
}

// Decays, lags and plays, and the products of two plain variables.
std::vector<Proposal> ByRow(const std::vector<PartScan>& scans) {
  std::vector<Proposal> proposals;
  for (const PartScan& scan : scans) {
    if (scan.by_direction || scan.hats) continue;
    for (const Form form : {Form::kDecay, Form::kLag, Form::kPlay}) {
      if (!IsProposed(form, scan.variable, scan.range)) continue;
      for (const double number : GridOf(form, scan.variable, scan.range).numbers) {
        proposals.push_back({scan.channel, {{form, scan.variable, {number}}}});
      }
    }
    if (IsSum(scan.variable)) continue;
    for (const PartScan& other : scans) {
      if (&other == &scan) break;
      if (other.by_direction || other.hats || IsSum(other.variable)) continue;
      proposals.push_back(
          {scan.channel, {{Form::kLinear, other.variable}, {Form::kLinear, scan.variable}}});
    }
    for (const PartScan& other : scans) {
      if (!other.by_direction || other.variable == scan.variable) continue;
      proposals.push_back(
          {scan.channel, {{Form::kLinear, scan.variable}, {Form::kSign, other.variable}}});
    }
  }
  return proposals;
}

std::vector<Proposal> ProductsOf(const std::vector<Rated>& best) {
  std::vector<Proposal> products;
  for (std::size_t i = 0; i < best.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Proposal &one = best[j].proposal, &other = best[i].proposal;
      if (one.channel.object != other.channel.object || one.atoms.size() > 1 ||
          other.atoms.size() > 1 || one.atoms[0].variable == other.atoms[0].variable) {
        continue;
      }
      if (one.columns() == 2 && other.columns() == 2) continue;
      products.push_back({one.channel, {one.atoms[0], other.atoms[0]}});
    }
  }
  return products;
}

// Asks the proposals of one channel.
std::vector<Rated> AskInChannel(const Fit& fit, const std::vector<Proposal>& proposals) {
  const StageChannel& channel = proposals.front().channel;
  std::vector<Index> groups;
  Index columns = 0;
  for (const Proposal& proposal : proposals) {
    groups.push_back(static_cast<Index>(proposal.columns()));
    columns += groups.back();
  }
  std::vector<MatrixXd> functions(fit.runs());
  VectorXd largest = VectorXd::Zero(columns);
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    functions[run] = MatrixXd::Zero(columns, trace.rows());
    std::map<std::string, Eigen::RowVectorXd> known;
    const auto values = [&](const std::string& variable, const simulation::Trace& of) {
      const auto [at, is_new] = known.try_emplace(variable);
      if (is_new) at->second = simulation::ValuesInUnit(variable, of);
      return at->second;
    };
    Index first = 0;
    for (std::size_t p = 0; p < proposals.size(); ++p) {
      const MatrixXd own = proposals[p].expression().Of(trace, values);
      if (own.rows() > 0) functions[run].middleRows(first, own.rows()) = own;
      first += groups[p];
    }
    largest = largest.cwiseMax(functions[run].rowwise().lpNorm<Eigen::Infinity>());
  }
  largest = (largest.array() > 0.0).select(largest, 1.0);
  for (MatrixXd& of_run : functions) {
    if (of_run.size() > 0) of_run = largest.cwiseInverse().asDiagonal() * of_run;
  }
  const auto projections = fit.ProjectInStage(channel.stage, functions, groups);
  std::vector<Rated> rated;
  Index first = 0;
  for (std::size_t p = 0; p < proposals.size(); ++p) {
    const auto& [S, g] = projections[p];
    Rated one{proposals[p]};
    one.coefficients = VectorXd::Zero(g.size());
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(S);
    for (Index i = 0; i < g.size(); ++i) {
      const double value = eigen.eigenvalues()[i];
      if (!(value > kHidden * eigen.eigenvalues().maxCoeff())) continue;
      const double along = eigen.eigenvectors().col(i).dot(g);
      one.chi_square += along * along / value;
      one.coefficients += along / value * eigen.eigenvectors().col(i);
    }
    const bool plausible = channel.IsPlausible(one.coefficients.norm());
    if (plausible) one.log_evidence = SizeOfDraws(projections[p], kSizes, 0.0).log_evidence;
    if (!plausible) one.chi_square = 0.0;
    one.coefficients =
        one.coefficients.cwiseQuotient(largest.segment(first, one.coefficients.size()));
    first += groups[p];
    rated.push_back(std::move(one));
  }
  return rated;
}

// The numbers of a proposal, one after the other, twice where there are two.
Rated WithNumbers(const Fit& fit, const Rated& rough, const std::vector<PartScan>& scans) {
  std::vector<std::size_t> which;
  for (std::size_t a = 0; a < rough.proposal.atoms.size(); ++a) {
    if (HasNumber(rough.proposal.atoms[a].form)) which.push_back(a);
  }
  Rated best = AskByRow(fit, {rough.proposal}).front();
  best.alike = rough.alike;
  if (which.empty()) return best;
  std::map<std::size_t, NumberPosterior> posteriors;
  const int rounds = which.size() > 1 ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    for (const std::size_t a : which) {
      const Atom& atom = best.proposal.atoms[a];
      const auto scan = std::ranges::find_if(scans, [&](const PartScan& each) {
        return each.channel.object == best.proposal.channel.object &&
               each.variable == atom.variable;
      });
      posteriors[a] =
          PosteriorOf(fit, best.proposal, a, GridOf(atom.form, atom.variable, scan->range));
      best = posteriors[a].best;
    }
  }
  best.alike = rough.alike;
  best.by_numbers = MatrixXd::Zero(best.coefficients.size(), best.coefficients.size());
  best.u95_of_numbers.clear();
  for (const std::size_t a : which) {
    best.log_evidence += posteriors[a].log_share;
    best.u95_of_numbers.push_back(posteriors[a].u95);
    best.by_numbers += posteriors[a].by_number;
  }
  return best;
}

}  // namespace

std::string LearnableOf(const std::string& variable) {
  return variable.starts_with("temp_") ? "warming of " + variable : variable;
}

std::vector<Rated> AskByRow(const Fit& fit, const std::vector<Proposal>& proposals) {
  constexpr std::size_t kAtOnce = 512;
  std::vector<Rated> all;
  for (std::size_t first = 0; first < proposals.size();) {
    std::size_t last = first;
    while (last < proposals.size() && last - first < kAtOnce &&
           proposals[last].channel.object == proposals[first].channel.object) {
      ++last;
    }
    for (Rated& rated : AskInChannel(fit, {proposals.begin() + first, proposals.begin() + last})) {
      all.push_back(std::move(rated));
    }
    first = last;
  }
  return all;
}

TermSearch SearchTerms(const Fit& fit, const std::vector<diagnosis::Found>& structures) {
  const auto channels = simulation::ChannelsOf(fit.campaign().scene());
  TermSearch search;
  search.channels = channels.size();
  search.structures = structures.size();
  std::vector<Rated> all;
  std::size_t most_scans = 1;
  for (const StageChannel& channel : channels) {
    std::vector<PartScan> scans = ScanParts(fit, channel);
    if (scans.empty()) continue;
    most_scans = std::max(most_scans, scans.size());
    AddOfParts(scans, all);
    const std::vector<Proposal> by_row = ByRow(scans);
    search.asked_by_row += by_row.size();
    for (Rated& rated : AskByRow(fit, by_row)) {
      if (rated.chi_square > kWorthAWord) all.push_back(std::move(rated));
    }
    std::ranges::move(scans, std::back_inserter(search.scans));
  }
  const double atoms = static_cast<double>(most_scans * Forms().size());
  KeepBest(all, kMultiplied, atoms);
  const std::vector<Proposal> products = ProductsOf(all);
  search.asked_by_row += products.size();
  for (Rated& rated : AskByRow(fit, products)) all.push_back(std::move(rated));
  // A number off by half a part costs so much that other forms may come first.
  std::vector<Rated> of_forms = all;
  KeepBest(of_forms, kRefined, atoms, true);
  KeepBest(all, kRefined, atoms);
  std::ranges::move(of_forms, std::back_inserter(all));
  KeepBest(all, 2 * kRefined, atoms);
  const double log_odds = std::log(diagnosis::kElse / static_cast<double>(channels.size()));
  for (const Rated& rough : all) {
    Rated rated = WithNumbers(fit, rough, search.scans);
    rated.log_posterior =
        rated.log_evidence + log_odds - LengthOf(rated.proposal) * std::log(atoms);
    search.best.push_back(std::move(rated));
  }
  std::ranges::stable_sort(search.best, std::greater(), &Rated::log_posterior);
  const diagnosis::Found* smooth = nullptr;
  for (const diagnosis::Found& found : structures) {
    if (found.structure.form != diagnosis::Structure::Form::kSmooth) continue;
    if (!simulation::IsVariable(LearnableOf(found.structure.variable))) continue;
    if (!smooth || found.drawn.log_evidence > smooth->drawn.log_evidence) smooth = &found;
  }
  if (smooth != nullptr && smooth->drawn.log_evidence > 0.0) {
    search.smooth = diagnosis::Refined(fit, *smooth);
    search.log_posterior_of_smooth = diagnosis::LogPosterior(*search.smooth, structures.size());
  }
  return search;
}

}  // namespace abbe::learned
