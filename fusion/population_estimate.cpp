#include "fusion/population_estimate.h"

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "estimation/in_parallel.h"
#include "failure/interruption.h"
#include "fusion/population_evidence.h"
#include "settings/unit.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Steps and bound of the search for ln k, the form of the target over what the file states.
constexpr std::array kFormSteps{0.5, 0.12};
constexpr double kMostForm = 2.5;
constexpr double kImpossible = -1e30;  // a logarithm of which rounding leaves nothing
constexpr double kSteady = 0.03;       // the same, and of noise
constexpr int kRounds = 4;
constexpr double kRowsOfPrior = 20.0;  // n
constexpr double kNoiseSeen = 4.0;     // standard deviations

class Estimate {
 public:
  Estimate(const machine::Machine& machine, const machine::VolumetricModel& model,
           const LinearRuns& runs)
      : evidence_(machine, model),
        runs_(runs),
        noise_(runs.noise),
        form_(runs.form_times),
        theta_(runs.theta) {}

  PopulationEstimate Run() {
    for (int round = 0; round < kRounds; ++round) {
      Maximise();
      const bool form = SetForm();
      if (!SetNoise() && !form) break;
    }
    PopulationEstimate seen{theta_, evidence_.PopulationAt(theta_), noise_, form_, Statements(), {},
                            {}};
    const MatrixXd C = (highest_.local.fisher + evidence_.precision()).inverse();
    seen.by_theta = evidence_.MovedByTheta(of_machine_, theta_, C);
    seen.seen = of_machine_;
    for (Index i = 0; i < theta_.size(); ++i) {
      const auto [line, axis, motion] = evidence_.knobs()[i];
      if (axis < 0 || line == kSmoothness || line == kWaveLength) continue;
      // The share of the variance of a size of nu degrees of freedom: 1 / (2 nu) by the data.
      const double by_data = highest_.local.fisher(i, i) * C(i, i) * C(i, i);
      double& size =
          line == kWave ? seen.population.wave[axis] : seen.population.deviation(axis, motion);
      size *= std::exp(2.0 * by_data);
    }
    return seen;
  }

 private:
  // Precision of the prior of a place of the target, with k times the form stated.
  double FormPrecision(double k) const {
    return runs_.form.empty() ? 1.0 : std::pow(k * runs_.form_stated, -2);
  }

  // Over all parameters, with so large a form, without the prior of the functions and squarenesses.
  // These and the form count from 0, all others from x.
  Quadratic All(double form) const {
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
    all.information.diagonal()(runs_.form).array() += FormPrecision(form);
    return all;
  }

  Quadratic OfMachine(double form) const {
    Quadratic seen = Marginalised(All(form), runs_.machine);
    seen.log += 0.5 * runs_.form.size() * std::log(FormPrecision(form));
    return seen;
  }

  void Maximise() {
    of_machine_ = OfMachine(form_);
    if (theta_.size() == 0) theta_ = evidence_.AtBestLength(of_machine_);
    highest_ = evidence_.Maximise(of_machine_, theta_, evidence_.count());
    theta_ = highest_.theta;
  }

  // False where nothing changes.
  bool SetForm() {
    if (runs_.form.empty() || runs_.form_known_to == 1.0) return false;
    const double before = form_, known_to = std::log(runs_.form_known_to);
    const auto log_at = [&](double log_form) {
      const Quadratic of_machine = OfMachine(std::exp(log_form));
      const double log = of_machine.log + evidence_.At(of_machine, theta_).log;
      return (std::isfinite(log) ? log : kImpossible) - 0.5 * std::pow(log_form / known_to, 2);
    };
    log_form_ = std::log(before);
    for (const double step : kFormSteps) {
      std::array<double, 3> logs{};
      estimation::InParallel(logs.size(), [&](std::size_t i) {
        logs[i] = log_at(log_form_ + (static_cast<double>(i) - 1.0) * step);
      });
      auto [below, here, above] = logs;
      while (above > here && log_form_ < kMostForm) {
        log_form_ += step;
        below = std::exchange(here, std::exchange(above, log_at(log_form_ + step)));
      }
      while (below > here && log_form_ > -kMostForm) {
        log_form_ -= step;
        above = std::exchange(here, std::exchange(below, log_at(log_form_ - step)));
      }
      // The parabola through the three.
      const double bend = std::max(2.0 * here - above - below, 1e-9);
      log_form_ += std::clamp(0.5 * step * (above - below) / bend, -step, step);
      form_variance_ = std::min(step * step / bend, known_to * known_to);
    }
    // The root mean square of what it may be, and no less than the file states.
    form_ = std::exp(std::max(log_form_ + form_variance_, 0.0));
    of_machine_ = OfMachine(form_);
    return std::abs(std::log(form_ / before)) > kSteady;
  }

  // False where nothing changes.
  bool SetNoise() {
    Quadratic all = All(form_);
    const MatrixXd L = evidence_.FactorAt(theta_);
    // Scaled by the prior of the machine, 1 elsewhere.
    const Index n = all.vector.size();
    MatrixXd S = MatrixXd::Identity(n, n);
    S(runs_.machine, runs_.machine) = L;
    const Eigen::SparseMatrix<double> by_prior = S.sparseView();
    MatrixXd B = by_prior.transpose() * MatrixXd(all.information * by_prior);
    for (const int column : runs_.machine) B(column, column) += 1.0;
    VectorXd scale = B.diagonal().cwiseSqrt();
    for (double& each : scale) each = each > 0.0 ? 1.0 / each : 1.0;
    MatrixXd scaled = scale.asDiagonal() * B * scale.asDiagonal();
    scaled.diagonal().array() += 1e-12;
    const MatrixXd root = scale.asDiagonal() * S.transpose();
    const Eigen::LLT<MatrixXd> factor(scaled);
    const MatrixXd half = factor.matrixL().solve(root);
    const MatrixXd C = half.transpose() * half;
    const VectorXd found = C * all.vector;
    VectorXd off = found;  // from x
    off(runs_.machine) -= runs_.values;
    off(runs_.form) -= runs_.form_values;
    std::vector<double> set(noise_.size());
    estimation::InParallel(set.size(), [&](std::size_t r) {
      const auto& run = runs_.runs[r];
      const double before = std::pow(noise_[r] / runs_.noise[r], 2);  // over that of the sums
      const double redundancy = runs_.rows[r] - run.information.cwiseProduct(C).sum() / before;
      const double chi_square =
          run.chi_square + 2.0 * run.gradient.dot(off) + off.dot(run.information * off);
      const double square = std::pow(runs_.noise[r], 2) * (chi_square + kRowsOfPrior) /
                            (std::max(redundancy, 0.0) + kRowsOfPrior);
      const double off_one = (square - 1.0) * std::sqrt((redundancy + kRowsOfPrior) / 2.0);
      set[r] = std::abs(off_one) > kNoiseSeen ? std::sqrt(square) : 1.0;
    });
    bool changed = false;
    for (std::size_t r = 0; r < set.size(); ++r) {
      changed = changed || std::abs(std::log(set[r] / noise_[r])) > kSteady;
    }
    noise_ = std::move(set);
    return changed;
  }

  std::vector<Statement> Statements() const {
    std::vector<Statement> statements = evidence_.Statements(highest_);
    if (form_variance_ > 0.0) {
      statements.push_back({.key = "target.form_nm",
                            .unit = 1e-9,
                            .stated = runs_.form_stated,
                            .seen = std::exp(std::max(log_form_, 0.0)) * runs_.form_stated,
                            .u_log = std::sqrt(form_variance_)});
    }
    return statements;
  }

  const PopulationEvidence evidence_;
  const LinearRuns& runs_;
  std::vector<double> noise_;
  double form_;
  double log_form_ = 0.0, form_variance_ = 0.0;  // most probable, and its variance
  VectorXd theta_;
  Quadratic of_machine_;
  PopulationEvidence::Maximum highest_;
};

}  // namespace

PopulationEstimate EstimatePopulation(const machine::Machine& machine,
                                      const machine::VolumetricModel& model,
                                      const LinearRuns& runs) {
  return Estimate(machine, model, runs).Run();
}

}  // namespace abbe::fusion
