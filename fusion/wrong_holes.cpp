#include "fusion/wrong_holes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "estimation/linearization.h"
#include "failure/failure.h"
#include "fusion/machine_prior.h"
#include "fusion/machine_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using simulation::PlateSetup;

constexpr double kWrong = 6.0;                       // standard deviations
constexpr double kBeyond = 3.0;                      // times the largest that stays
constexpr double kWholeAhead = 16.0;                 // of chi-square
constexpr double kMedianOfTwo = 1.3862943611198906;  // of chi-square with two degrees of freedom
constexpr Index kOneIn = 20;                         // readings of a set-up may go
constexpr int kNoiseRounds = 4;

// A reading: two rows.
struct Reading {
  std::size_t setup;
  Index point;
  const PlateSetup* of;
  bool kept = true, anywhere = false;
  double T = 0.0;

  int hole() const { return of->holes[point]; }
};

// All set-ups at the perfect machine.
class LinearPlates {
 public:
  LinearPlates(const machine::Machine& machine, const std::vector<PlateSetup>& setups) {
    const machine::VolumetricModel model = UnknownMachine(machine);
    std::vector<simulation::SimulatedRun> runs;
    for (std::size_t s = 0; s < setups.size(); ++s) {
      runs.push_back(simulation::SimulatePlate(model, machine.reference, setups[s]));
      for (Index i = 0; i < setups[s].points.count(); ++i) {
        readings_.push_back({.setup = s, .point = i, .of = &setups[s]});
      }
    }
    const estimation::Problem problem = MakeMachineProblem(
        machine, model, MachinePrior(machine, model, PopulationOf(machine)), runs);
    const estimation::Layout layout(problem);
    const estimation::Linearization at = estimation::Linearize(problem, layout, layout.start, 0);
    if (!at.trouble.empty()) throw NumericalError(at.trouble);
    priors_ = at.prior.information;
    score_ = at.prior.gradient;
    for (std::size_t source = runs.size(); source < at.sources.size(); ++source) {
      priors_ += at.sources[source].information;
      score_ += at.sources[source].gradient;
    }
    J_ = MatrixXd::Zero(2 * std::ssize(readings_), layout.columns());
    r_.resize(J_.rows());
    Index row = 0;
    estimation::VisitRows(problem, layout, layout.start, true, [&](const auto& rows) {
      if (rows.term->source.index >= std::ssize(runs)) return;
      r_.segment(row, rows.r.size()) = rows.r;
      for (std::size_t c = 0; c < rows.columns.size(); ++c) {
        J_.col(rows.columns[c]).segment(row, rows.r.size()) += rows.jacobian.col(c);
      }
      row += rows.r.size();
    });
    scale_ = (priors_.diagonal() + J_.colwise().squaredNorm().transpose()).cwiseSqrt();
    scale_ = (scale_.array() > 0.0).select(scale_.cwiseInverse(), 1.0);
  }

  std::vector<Reading>& readings() { return readings_; }

  // Solves with the kept readings and tests each of them, the noise as these have it.
  void Solve() {
    for (int round = 0; round < kNoiseRounds; ++round) {
      SolveAt(noise_);
      std::vector<double> all;
      for (const Reading& reading : readings_) {
        if (reading.kept) all.push_back(reading.T);
      }
      std::ranges::nth_element(all, all.begin() + std::ssize(all) / 2);
      const double times = all[all.size() / 2] / kMedianOfTwo;
      noise_ = std::max(1.0, noise_ * std::sqrt(times));
    }
    SolveAt(noise_);
  }

  // T of one shift of all these readings.
  double TestOf(const std::vector<Index>& of) const {
    std::vector<Index> rows;
    for (const Index i : of) {
      rows.push_back(2 * i);
      rows.push_back(2 * i + 1);
    }
    const double w = 1.0 / (noise_ * noise_);
    const MatrixXd K = K_(rows, Eigen::all);
    const MatrixXd gain = K * K.transpose();
    Vector2d g = Vector2d::Zero();
    Matrix2d S = Matrix2d::Zero();
    for (std::size_t a = 0; a < of.size(); ++a) {
      g += w * e_.segment<2>(2 * of[a]);
      S += w * Matrix2d::Identity();
      for (std::size_t b = 0; b < of.size(); ++b) {
        S -= w * w * gain.block<2, 2>(2 * a, 2 * b);
      }
    }
    const Eigen::LDLT<Matrix2d> factor(S);
    return factor.isPositive() && S.diagonal().minCoeff() > 1e-9 * w ? g.dot(factor.solve(g)) : 0.0;
  }

  // What is left of a reading, m.
  Vector2d Left(Index reading) const {
    return readings_[reading].of->u_probing * e_.segment<2>(2 * reading);
  }

 private:
  void SolveAt(double noise) {
    const double w = 1.0 / (noise * noise);
    VectorXd weights(J_.rows());
    for (Index i = 0; i < std::ssize(readings_); ++i) {
      weights.segment<2>(2 * i).setConstant(readings_[i].kept ? w : 0.0);
    }
    const MatrixXd J = J_ * scale_.asDiagonal();
    const MatrixXd weighted = weights.cwiseSqrt().asDiagonal() * J;
    MatrixXd H = scale_.asDiagonal() * priors_ * scale_.asDiagonal();
    H += weighted.transpose() * weighted;
    H.diagonal().array() += 1e-12;
    const Eigen::LLT<MatrixXd> factor(H);
    const VectorXd gradient =
        scale_.cwiseProduct(score_) + J.transpose() * weights.cwiseProduct(r_);
    const VectorXd step = factor.solve(gradient);
    e_ = r_ - J * step;
    const MatrixXd columns = J.transpose();
    const MatrixXd solved = factor.matrixL().solve(columns);
    K_ = solved.transpose();
    for (Index i = 0; i < std::ssize(readings_); ++i) {
      if (readings_[i].kept) readings_[i].T = TestOf({i});
    }
  }

  std::vector<Reading> readings_;
  MatrixXd priors_, J_, K_;  // K K' = J H^-1 J'
  VectorXd score_, r_, e_, scale_;
  double noise_ = 1.0;
};

using OfHole = std::map<std::pair<std::string, int>, std::vector<Index>>;

// The readings that are left of each hole.
OfHole KeptOfHoles(const std::vector<Reading>& readings) {
  OfHole of_hole;
  for (Index i = 0; i < std::ssize(readings); ++i) {
    const Reading& each = readings[i];
    if (each.kept) of_hole[{each.of->plate, each.hole()}].push_back(i);
  }
  return of_hole;
}

// Leaves out the worst reading, or hole; false where nothing is wrong any more.
bool LeaveOutWorst(LinearPlates& plates) {
  std::vector<Reading>& readings = plates.readings();
  double most = kWrong * kWrong;
  std::vector<Index> worst;
  for (Index i = 0; i < std::ssize(readings); ++i) {
    if (!readings[i].kept || readings[i].T <= most) continue;
    most = readings[i].T;
    worst = {i};
  }
  if (!worst.empty()) most += kWholeAhead;
  for (const auto& [name, of] : KeptOfHoles(readings)) {
    if (of.size() < 2) continue;
    const double T = plates.TestOf(of);
    if (T <= most) continue;
    most = T;
    worst = of;
  }
  for (const Index i : worst) {
    readings[i].kept = false;
    readings[i].anywhere = worst.size() > 1;
    readings[i].T = most;
  }
  return !worst.empty();
}

bool TooMany(const std::vector<Reading>& readings) {
  std::map<std::size_t, std::pair<Index, Index>> of_setup;  // gone, all
  for (const Reading& each : readings) {
    auto& [gone, all] = of_setup[each.setup];
    gone += each.kept ? 0 : 1;
    ++all;
  }
  return std::ranges::any_of(of_setup, [](const auto& each) {
    const auto [gone, all] = each.second;
    return gone > std::max<Index>(1, all / kOneIn);
  });
}

// Whether it is far beyond all that stay in its set-up: what a machine does, several holes show.
bool StandsOut(const Reading& reading, const std::vector<Reading>& readings) {
  return std::ranges::none_of(readings, [&](const Reading& other) {
    return other.kept && other.setup == reading.setup && kBeyond * kBeyond * other.T > reading.T;
  });
}

}  // namespace

std::vector<WrongHole> FindWrongHoles(const machine::Machine& machine,
                                      const std::vector<PlateSetup>& setups) {
  if (setups.empty()) return {};
  LinearPlates plates(machine, setups);
  do {
    plates.Solve();
    if (TooMany(plates.readings())) return {};
  } while (LeaveOutWorst(plates));
  std::vector<WrongHole> wrong;
  const std::vector<Reading>& readings = plates.readings();
  for (Index i = 0; i < std::ssize(readings); ++i) {
    const Reading& each = readings[i];
    if (each.kept || !StandsOut(each, readings)) continue;
    wrong.push_back(
        {each.setup, each.point, each.hole(), plates.Left(i), std::sqrt(each.T), each.anywhere});
  }
  return wrong;
}

std::vector<PlateSetup> WithoutHoles(std::vector<PlateSetup> setups,
                                     const std::vector<WrongHole>& wrong) {
  for (std::size_t s = 0; s < setups.size(); ++s) {
    std::vector<Index> kept;
    for (Index i = 0; i < setups[s].points.count(); ++i) {
      const bool gone = std::ranges::any_of(
          wrong, [&](const WrongHole& each) { return each.setup == s && each.point == i; });
      if (!gone) kept.push_back(i);
    }
    if (std::ssize(kept) < setups[s].points.count()) {
      setups[s] = simulation::PartOf(setups[s], kept);
    }
  }
  return setups;
}

}  // namespace abbe::fusion
