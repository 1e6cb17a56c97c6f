#include "learned/part_scan.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "random/counter_random.h"
#include "simulation/variables.h"

namespace abbe::learned {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::Trace;

constexpr double kAbsorbed = 1e-6;  // of its information: what is left is rounding

bool HasSign(const std::string& variable) {
  return (variable.size() == 1 || variable.starts_with("pivot_"));
}

// The scans of a channel before the data: ranges of the variables that its runs have.
std::vector<PartScan> EmptyScans(const diagnosis::Fit& fit, const StageChannel& channel) {
  const simulation::Scene scene = fit.campaign().scene();
  std::vector<PartScan> scans;
  for (const std::string& variable : simulation::VariablesToLearnFrom(scene)) {
    const auto range = diagnosis::RangeOf(variable, channel, scene);
    if (!range) continue;
    const double unit = simulation::UnitOf(variable).si;
    const diagnosis::Range own{range->first / unit, range->last / unit};
    const VectorXd borders = VectorXd::LinSpaced(kParts + 1, own.first, own.last);
    const VectorXd middles = 0.5 * (borders.head(kParts) + borders.tail(kParts));
    scans.push_back({channel, variable, false, false, own, middles, {}, {}});
    scans.push_back({channel, variable, false, true, own, borders, {}, {}});
    if (!HasSign(variable)) continue;
    scans.push_back(scans.back());
    scans.back().by_direction = true;
  }
  return scans;
}

// What each row counts for each part or hat.
void AddRows(const PartScan& scan, const Trace& trace, Eigen::Ref<MatrixXd> functions) {
  const RowVectorXd values = simulation::ValuesInUnit(scan.variable, trace);
  if (values.size() == 0) return;
  RowVectorXd signs = RowVectorXd::Ones(values.size());
  if (scan.by_direction) {
    const MatrixXd own = simulation::ValuesOfAtom({Atom::Form::kSign, scan.variable}, trace);
    if (own.size() == 0) return;
    signs = own.row(0);
  }
  const double scale = static_cast<double>(kParts) / scan.range.Length();
  for (Index row = 0; row < values.size(); ++row) {
    const double at = (values[row] - scan.range.first) * scale;
    const Index part = std::clamp(static_cast<Index>(std::floor(at)), Index{0}, kParts - 1);
    const double on = std::clamp(at - static_cast<double>(part), 0.0, 1.0);
    functions(part, row) = scan.hats ? (1.0 - on) * signs[row] : signs[row];
    if (scan.hats) functions(part + 1, row) = on * signs[row];
  }
}

struct Explained {
  double chi_square = 0.0;
  std::size_t freedom = 0;
};

// For one or two functions.
Explained ExplainedBy(const MatrixXd& S, const VectorXd& g, const MatrixXd& f) {
  const MatrixXd information = f * S * f.transpose();
  const VectorXd score = f * g;
  if (f.rows() == 1) {
    if (!(information(0, 0) > 0.0)) return {};
    return {score[0] * score[0] / information(0, 0), 1};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(information);
  Explained explained;
  for (Index i = 0; i < 2; ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * eigen.eigenvalues()[1])) continue;
    const double along = eigen.eigenvectors().col(i).dot(score);
    explained.chi_square += along * along / value;
    ++explained.freedom;
  }
  return explained;
}

std::vector<Atom> AtomsOf(Atom::Form form, const PartScan& scan) {
  if (scan.hats == (form == Atom::Form::kStep)) return {};
  if (!IsAskedOfParts(form) || !IsProposed(form, scan.variable, scan.range)) return {};
  if (!HasNumber(form)) return {{form, scan.variable}};
  std::vector<Atom> atoms;
  for (const double number : GridOf(form, scan.variable, scan.range).numbers) {
    atoms.push_back({form, scan.variable, {number}});
  }
  return atoms;
}

}  // namespace

bool IsAskedOfParts(Atom::Form form) {
  return form != Atom::Form::kLag && form != Atom::Form::kPlay && form != Atom::Form::kDecay;
}

std::vector<PartScan> ScanParts(const diagnosis::Fit& fit, const StageChannel& channel) {
  std::vector<PartScan> scans = EmptyScans(fit, channel);
  std::vector<Index> groups;
  Index columns = 0;
  for (const PartScan& scan : scans) {
    groups.push_back(scan.at.size());
    columns += groups.back();
  }
  std::vector<MatrixXd> functions(fit.runs());
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    functions[run] = MatrixXd::Zero(columns, trace.rows());
    Index first = 0;
    for (const PartScan& scan : scans) {
      AddRows(scan, trace, functions[run].middleRows(first, scan.at.size()));
      first += scan.at.size();
    }
  }
  auto projections = fit.ProjectInStage(channel.stage, functions, groups);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    scans[s].S = std::move(projections[s].information);
    scans[s].g = std::move(projections[s].score);
  }
  return scans;
}

MatrixXd OverParts(const Atom& atom, const PartScan& scan) {
  const auto values = [&](const std::string&, const Trace&) -> RowVectorXd {
    return scan.at.transpose();
  };
  const Trace none;
  MatrixXd f = simulation::ValuesOfAtom(atom, none, values);
  if (atom.form == Atom::Form::kSine) {
    Atom cosine = atom;
    cosine.form = Atom::Form::kCosine;
    f.conservativeResize(2, Eigen::NoChange);
    f.row(1) = simulation::ValuesOfAtom(cosine, none, values);
  }
  return f;
}

Asked BestOf(const PartScan& scan, Atom::Form form) {
  Asked best;
  for (const Atom& atom : AtomsOf(form, scan)) {
    const double chi_square = ExplainedBy(scan.S, scan.g, OverParts(atom, scan)).chi_square;
    if (chi_square > best.chi_square) best = {atom, chi_square};
  }
  return best;
}

double LogChanceOf(double chi_square, std::size_t columns) {
  if (columns == 2) return -0.5 * chi_square;
  const double chance = std::erfc(std::sqrt(0.5 * chi_square));
  // Mills' ratio where that is too small for a number.
  return chance > 0.0 ? std::log(chance)
                      : -0.5 * chi_square - 0.5 * std::log(0.5 * M_PI * chi_square);
}

std::vector<double> LeastChances(const std::vector<PartScan>& scans, int draws,
                                 std::uint64_t seed) {
  std::vector<double> least(static_cast<std::size_t>(draws), 0.0);
  // A pool, read from another place for each scan: so many draws of each would take seconds.
  constexpr std::size_t kPool = std::size_t{1} << 18;
  constexpr std::size_t kStride = 40'009;  // a prime
  std::vector<double> pool(kPool);
  const random::CounterRandom random(seed, 0x1EA2);
  for (std::size_t i = 0; i < kPool; ++i) pool[i] = random.Normal(i);
  std::size_t place = 0;
  for (const PartScan& scan : scans) {
    // g = B z with B B' = S.
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scan.S);
    const MatrixXd B =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    // All atoms, scaled to unit information; waves as pairs that are orthogonal.
    std::vector<VectorXd> singles, waves;
    for (const Atom::Form form : Forms()) {
      for (const Atom& atom : AtomsOf(form, scan)) {
        const MatrixXd f = OverParts(atom, scan);
        const MatrixXd information = f * scan.S * f.transpose();
        const Eigen::SelfAdjointEigenSolver<MatrixXd> of(information);
        const double most = of.eigenvalues().maxCoeff();
        if (!(most > 0.0)) continue;
        for (Index i = 0; i < f.rows(); ++i) {
          const double value = of.eigenvalues()[i];
          const bool absorbed = !(value > kAbsorbed * most);
          VectorXd unit = VectorXd::Zero(scan.at.size());
          if (!absorbed) unit = f.transpose() * of.eigenvectors().col(i) / std::sqrt(value);
          (f.rows() == 1 ? singles : waves).push_back(std::move(unit));
        }
      }
    }
    if (singles.empty() && waves.empty()) continue;
    const auto matrix = [&](const std::vector<VectorXd>& columns) {
      MatrixXd all(scan.at.size(), static_cast<Index>(columns.size()));
      for (Index c = 0; c < all.cols(); ++c) all.col(c) = columns[static_cast<std::size_t>(c)];
      return all;
    };
    MatrixXd z(scan.at.size(), draws);
    place += kStride;
    for (Index i = 0; i < z.size(); ++i) {
      z.data()[i] = pool[(place + static_cast<std::size_t>(i)) % kPool];
    }
    const MatrixXd g = B * z;
    const MatrixXd of_singles = (matrix(singles).transpose() * g).cwiseAbs2(),
                   of_waves = (matrix(waves).transpose() * g).cwiseAbs2();
    for (Index c = 0; c < draws; ++c) {
      double chance = 0.0;
      if (of_singles.rows() > 0) chance = LogChanceOf(of_singles.col(c).maxCoeff(), 1);
      for (Index w = 0; w + 1 < of_waves.rows(); w += 2) {
        chance = std::min(chance, LogChanceOf(of_waves(w, c) + of_waves(w + 1, c), 2));
      }
      auto& of_draw = least[static_cast<std::size_t>(c)];
      of_draw = std::min(of_draw, chance);
    }
  }
  std::ranges::sort(least);
  return least;
}

}  // namespace abbe::learned
