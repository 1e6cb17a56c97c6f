#include "fusion/population_estimate.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>

#include "failure/interruption.h"
#include "fusion/population_evidence.h"
#include "settings/unit.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array kCommonLengths{0.25, 0.35, 0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0};
// Form of the target, times what the file states.
constexpr std::array kForms{1.0, 1.41, 2.0, 2.83, 4.0, 5.66};
constexpr double kFormSize = 0.7;  // standard deviation of its logarithm
constexpr double kLongestStep = 0.7;
constexpr double kGainSettled = 0.01;  // of log Z
constexpr int kSteps = 12, kRounds = 4;
constexpr double kRowsOfPrior = 20.0;  // n
constexpr double kNoiseSeen = 4.0;     // standard deviations
// Standard deviations: of a logarithm above, and below, where that of a size of a few degrees of
// freedom scatters further.
constexpr double kRefutedAbove = 3.5, kRefutedBelow = 5.0;
constexpr double kTold = 0.5;  // u of a logarithm, at most
const double kHardlyOff = std::log(1.33);

class Estimate {
 public:
  Estimate(const machine::Machine& machine, const machine::VolumetricModel& model,
           const LinearRuns& runs)
      : machine_(machine),
        evidence_(machine, model),
        runs_(runs),
        noise_(runs.noise),
        form_(runs.form_times),
        theta_(runs.theta) {}

  PopulationEstimate Run() {
    if (theta_.size() == 0) StartAtBestLength();
    for (int round = 0; round < kRounds; ++round) {
      Maximise();
      const bool form = SetForm();
      if (!SetNoise() && !form) break;
    }
    PopulationEstimate seen{theta_, evidence_.PopulationAt(theta_), noise_, form_, Statements(),
                            {}};
    const MatrixXd C = (local_.fisher + evidence_.precision()).inverse();
    seen.by_theta = evidence_.MovedByTheta(of_machine_, theta_, C);
    for (Index i = 0; i < theta_.size(); ++i) {
      const auto [line, axis, motion] = evidence_.knobs()[i];
      if (axis < 0 || line == kSmoothness) continue;
      // The share of the variance of a size of nu degrees of freedom: 1 / (2 nu) by the data.
      const double by_data = local_.fisher(i, i) * C(i, i) * C(i, i);
      seen.population.deviation(axis, motion) *= std::exp(2.0 * by_data);
    }
    return seen;
  }

 private:
  // Of the prior of a place of the target with k times the form stated.
  double FormPrecision(double k) const {
    return runs_.form.empty() ? 1.0 : std::pow(k * runs_.form_stated, -2);
  }

  // Over all parameters, without the prior of the functions and squarenesses. These and the form
  // count from 0, all others from x.
  Quadratic All() const {
    Quadratic all{runs_.prior.information, -runs_.prior.gradient};
    for (std::size_t r = 0; r < runs_.runs.size(); ++r) {
      const double weight = std::pow(runs_.noise[r] / noise_[r], 2);
      all.information += weight * runs_.runs[r].information;
      all.vector -= weight * runs_.runs[r].gradient;
    }
    VectorXd x = VectorXd::Zero(all.vector.size());
    x(runs_.machine) = runs_.values;
    x(runs_.form) = runs_.form_values;
    const double of_sums = FormPrecision(runs_.form_times);
    for (const int column : runs_.form) {
      all.information(column, column) -= of_sums;
      all.vector[column] += of_sums * x[column];
    }
    for (int k = 0; k < 3; ++k) {  // the prior of the fit; theta has its own
      const int column = runs_.machine[evidence_.squareness() + k];
      const double precision = std::pow(runs_.squareness, -2);
      all.information(column, column) -= precision;
      all.vector[column] += precision * runs_.values[evidence_.squareness() + k];
    }
    all.vector += all.information * x;
    all.information.diagonal()(runs_.form).array() += FormPrecision(form_);
    return all;
  }

  Quadratic OfMachine() const {
    const Quadratic all = All();
    std::vector<bool> is_machine(all.vector.size(), false);
    for (const int column : runs_.machine) is_machine[column] = true;
    std::vector<int> others;
    for (int i = 0; i < all.vector.size(); ++i) {
      if (!is_machine[i] && all.information(i, i) > 0.0) others.push_back(i);
    }
    const VectorXd scale = all.information.diagonal()(others).cwiseSqrt().cwiseInverse();
    MatrixXd inner = scale.asDiagonal() * all.information(others, others) * scale.asDiagonal();
    inner.diagonal().array() += 1e-12;  // rounding
    const MatrixXd cross = scale.asDiagonal() * all.information(others, runs_.machine);
    const VectorXd right = scale.asDiagonal() * all.vector(others);
    const Eigen::LLT<MatrixXd> factor(inner);
    const MatrixXd half = factor.matrixL().solve(cross);
    const VectorXd left = factor.matrixL().solve(right);
    const double log =
        0.5 * left.squaredNorm() - factor.matrixLLT().diagonal().array().log().sum() +
        scale.array().log().sum() + 0.5 * runs_.form.size() * std::log(FormPrecision(form_));
    return {all.information(runs_.machine, runs_.machine) - half.transpose() * half,
            all.vector(runs_.machine) - half.transpose() * left, log};
  }

  void StartAtBestLength() {
    theta_ = VectorXd::Zero(evidence_.count());
    of_machine_ = OfMachine();
    double best = -std::numeric_limits<double>::infinity();
    VectorXd chosen = theta_;
    for (const double factor : kCommonLengths) {
      VectorXd theta = theta_;
      for (std::size_t i = 0; i < evidence_.knobs().size(); ++i) {
        if (evidence_.knobs()[i].line == kSmoothness) theta[i] = std::log(factor);
      }
      const double log = evidence_.At(of_machine_, theta).log;
      if (log > best) {
        best = log;
        chosen = theta;
      }
    }
    theta_ = chosen;
  }

  void Maximise() {
    of_machine_ = OfMachine();
    auto now = evidence_.At(of_machine_, theta_);
    for (int step = 0; step < kSteps; ++step) {
      MayBeInterrupted();
      local_ = evidence_.SlopesAt(of_machine_, theta_, now);
      const VectorXd slope = local_.gradient - evidence_.precision() * theta_;
      VectorXd way = (local_.fisher + evidence_.precision()).ldlt().solve(slope);
      const double gain = 0.5 * slope.dot(way);
      if (gain < kGainSettled) return;
      way *= std::min(1.0, kLongestStep / way.cwiseAbs().maxCoeff());
      auto next = evidence_.At(of_machine_, theta_ + way);
      for (int halves = 0; halves < 5 && !(next.log > now.log); ++halves) {
        way *= 0.4;
        next = evidence_.At(of_machine_, theta_ + way);
      }
      if (!(next.log > now.log)) return;
      theta_ += way;
      now = std::move(next);
    }
  }

  // False where nothing changes.
  bool SetForm() {
    if (runs_.form.empty()) return false;
    const double before = form_;
    double best = -std::numeric_limits<double>::infinity(), chosen = form_;
    double as_stated = 0.0;
    for (const double k : kForms) {
      form_ = k;
      of_machine_ = OfMachine();
      const double log = of_machine_.log + evidence_.At(of_machine_, theta_).log;
      if (k == kForms.front()) as_stated = log;
      const double with_prior = log - 0.5 * std::pow(std::log(k) / kFormSize, 2);
      if (with_prior <= best) continue;
      best = with_prior;
      chosen = k;
      form_gain_ = log - as_stated;
    }
    form_ = chosen;
    of_machine_ = OfMachine();
    return form_ != before;
  }

  // False where nothing changes.
  bool SetNoise() {
    Quadratic all = All();
    const MatrixXd L = evidence_.FactorAt(theta_);
    // Scaled by the prior of the machine, 1 elsewhere.
    const Index n = all.vector.size();
    MatrixXd S = MatrixXd::Identity(n, n);
    S(runs_.machine, runs_.machine) = L;
    MatrixXd B = S.transpose() * all.information * S;
    for (const int column : runs_.machine) B(column, column) += 1.0;
    VectorXd scale = B.diagonal().cwiseSqrt();
    for (double& each : scale) each = each > 0.0 ? 1.0 / each : 1.0;
    MatrixXd scaled = scale.asDiagonal() * B * scale.asDiagonal();
    scaled.diagonal().array() += 1e-12;
    const MatrixXd root = S * scale.asDiagonal();
    const Eigen::LLT<MatrixXd> factor(scaled);
    const VectorXd found = root * factor.solve(root.transpose() * all.vector);
    VectorXd off = found;  // from x
    off(runs_.machine) -= runs_.values;
    off(runs_.form) -= runs_.form_values;
    bool changed = false;
    for (std::size_t r = 0; r < runs_.runs.size(); ++r) {
      const auto& run = runs_.runs[r];
      const MatrixXd seen = root.transpose() * run.information * root;
      const double before = std::pow(noise_[r] / runs_.noise[r], 2);  // over that of the sums
      const double redundancy = runs_.rows[r] - factor.solve(seen).trace() / before;
      const double chi_square =
          run.chi_square + 2.0 * run.gradient.dot(off) + off.dot(run.information * off);
      const double square = std::pow(runs_.noise[r], 2) * (chi_square + kRowsOfPrior) /
                            (std::max(redundancy, 0.0) + kRowsOfPrior);
      const double off_one = (square - 1.0) * std::sqrt((redundancy + kRowsOfPrior) / 2.0);
      const double set = std::abs(off_one) > kNoiseSeen ? std::sqrt(square) : 1.0;
      changed = changed || std::abs(std::log(set / noise_[r])) > 0.03;
      noise_[r] = set;
    }
    return changed;
  }

  // The line that all its errors share, with all lines free: each weighted by what the runs tell.
  std::vector<Statement> Statements() const {
    const machine::Population& p = machine_.population;
    using settings::kMicro;
    std::vector<Statement> statements;
    const auto add = [&](std::string_view key, double unit, double stated) {
      statements.push_back({.key = key, .unit = unit, .stated = stated});
    };
    add("population.positioning_um", kMicro, p.positioning);
    add("population.straightness_um", kMicro, p.straightness);
    add("population.roll_urad", kMicro, p.roll);
    add("population.pitch_urad", kMicro, p.pitch);
    add("population.yaw_urad", kMicro, p.yaw);
    add("population.squareness_urad", kMicro, p.squareness);
    add("population.scale_ppm", kMicro, p.scale);
    add(kSmoothnessKey, settings::kMillimetre, p.smoothness);
    MatrixXd X = MatrixXd::Zero(evidence_.knobs().size(), kLines);
    for (std::size_t i = 0; i < evidence_.knobs().size(); ++i)
      X(i, evidence_.knobs()[i].line) = 1.0;
    MatrixXd information = X.transpose() * local_.fisher * X;
    information.diagonal().array() += 1e-9;
    const MatrixXd C = information.inverse();
    const VectorXd logs = C * X.transpose() * ((local_.fisher + evidence_.precision()) * theta_);
    for (Index line = 0; line < kLines; ++line) {
      Statement& each = statements[line];
      each.u_log = std::sqrt(C(line, line));
      each.seen = each.stated * std::exp(logs[line]);
    }
    if (!runs_.form.empty()) {
      const double off = std::log(form_);
      statements.push_back({.key = "target.form_nm",
                            .unit = 1e-9,
                            .stated = runs_.form_stated,
                            .seen = form_ * runs_.form_stated,
                            .u_log = off / std::sqrt(2.0 * std::max(form_gain_, 0.5))});
    }
    return statements;
  }

  const machine::Machine& machine_;
  const PopulationEvidence evidence_;
  const LinearRuns& runs_;
  std::vector<double> noise_;
  double form_;
  double form_gain_ = 0.0;  // of log Z, against the form that is stated
  VectorXd theta_;
  Quadratic of_machine_;
  PopulationEvidence::Slopes local_;
};

}  // namespace

bool Statement::Refuted() const {
  const double off = std::log(seen / stated);
  const double bound = (off > 0.0 ? kRefutedAbove : kRefutedBelow) * u_log;
  return u_log < kTold && std::abs(off) > std::max(kHardlyOff, bound);
}

PopulationEstimate EstimatePopulation(const machine::Machine& machine,
                                      const machine::VolumetricModel& model,
                                      const LinearRuns& runs) {
  return Estimate(machine, model, runs).Run();
}

}  // namespace abbe::fusion
