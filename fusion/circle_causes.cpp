#include "fusion/circle_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "estimation/problem.h"
#include "failure/failure.h"
#include "standards/circle_signatures.h"
#include "standards/student_coverage.h"

namespace abbe::fusion {
namespace {

using estimation::Problem;
using paths::CirclePoint;
using paths::CircleRun;
using standards::Signature;

constexpr std::size_t kSectors = 36;  // their means show the correlation of neighbouring rows
// m: the first guess of the noise, below that of any instrument of a machine shop and so small that
// the priors have no effect.
constexpr double kLeastRadialNoise = 10e-9;
constexpr double kSameRadius = 0.01;      // of the radius: lag makes a fast circle smaller
constexpr double kLargePart = 0.3;        // of a weak direction of length 1
constexpr double kRowsOfParameter = 1.5;  // at least
constexpr double kLeastFreedom = 3.0;     // rows beyond the causes and centres

bool IsCentre(const Signature& signature) { return signature.cause == "centre"; }

std::string Name(const Signature& signature) { return signature.cause + "." + signature.object; }

void CheckCircles(const std::vector<const CircleRun*>& runs) {
  if (runs.empty()) throw InputError("no circle to find the causes of");
  for (const CircleRun* run : runs) {
    if (run->plane.Inclined()) {
      throw InputError(fmt::format(
          "{}: the circle lies in no plane of two axes: its causes cannot be assigned to axes",
          run->recordings.front()));
    }
    if (run->plane.name != runs.front()->plane.name ||
        run->instrument != runs.front()->instrument ||
        std::abs(run->radius - runs.front()->radius) > kSameRadius * run->radius) {
      throw InputError(
          fmt::format("{} and {}: circles of another plane, radius or instrument: fit each alone",
                      runs.front()->recordings.front(), run->recordings.front()));
    }
  }
}

// How backlash is taken up, and on which way of the first and the second axis, m.
struct BacklashForm {
  standards::TakenUp how = standards::TakenUp::kAtOnce;
  std::array<double, 2> way{};
};

std::vector<Signature> SignaturesOf(const CircleRun& run, const CauseOptions& options,
                                    const BacklashForm& form) {
  return standards::CircleSignatures({.first = run.plane.name[0],
                                      .second = run.plane.name[1],
                                      .first_centre = run.plane.first.dot(run.centre),
                                      .second_centre = run.plane.second.dot(run.centre),
                                      .pitch = options.pitch,
                                      .spike_width = options.spike_width,
                                      .taken_up = form.how,
                                      .way = form.way});
}

double Radial(const CirclePoint& point, double radius) {
  return std::hypot(point.first, point.second) - radius;
}

// Radial deviations of a run, and their derivatives with respect to the centre, each cause, the
// harmonics of smooth errors and the errors of the instrument.
struct Equations {
  Eigen::MatrixXd centre, causes, smooth, instrument;
  Eigen::VectorXd radial;
};

// cos, sin of each order, the same in both senses and at any feed.
Eigen::MatrixXd Waves(const CircleRun& run, std::size_t orders) {
  Eigen::MatrixXd waves(run.points.size(), 2 * orders);
  for (Eigen::Index i = 0; i < waves.rows(); ++i) {
    const double t = run.points[i].angle;
    for (Eigen::Index k = 0; k < waves.cols(); k += 2) {
      const Eigen::Index order = kFirstHarmonic + k / 2;
      const double phase = order * t;
      waves(i, k) = std::cos(phase);
      waves(i, k + 1) = std::sin(phase);
    }
  }
  return waves;
}

Equations EquationsOf(const CircleRun& run, const CauseOptions& options, const BacklashForm& form) {
  const std::vector<Signature> table = SignaturesOf(run, options, form);
  const Eigen::Index n = run.points.size();
  const auto centres = std::ranges::count_if(table, IsCentre);
  Equations equations{Eigen::MatrixXd(n, centres), Eigen::MatrixXd(n, table.size() - centres),
                      Waves(run, options.smooth.size()), Eigen::MatrixXd(n, options.shifted.size()),
                      Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const CirclePoint& point = run.points[i];
    const standards::CirclePoint at{point.angle, static_cast<double>(point.sense), run.radius,
                                    run.feed};
    Eigen::Index centre = 0, cause = 0;
    for (const Signature& signature : table) {
      (IsCentre(signature) ? equations.centre(i, centre++) : equations.causes(i, cause++)) =
          signature.radial(at);
    }
    // The distance to the set-up centre; the square of the centre's offset in it is no deviation of
    // the path.
    equations.radial[i] = Radial(point, run.radius);
  }
  return equations;
}

// The run about `middle` instead of the set-up centre, so that the square of the centre's offset is
// negligible.
CircleRun About(const Eigen::Vector2d& middle, const CircleRun& run) {
  CircleRun centred = run;
  for (CirclePoint& point : centred.points) {
    point.first -= middle.x();
    point.second -= middle.y();
  }
  return centred;
}

// The equations of run number `at`, about its middle.
Equations CentredEquations(const std::vector<const CircleRun*>& runs, std::size_t at,
                           const CauseOptions& options, const BacklashForm& form) {
  const Eigen::Vector2d middle = runs[at]->middle;
  Equations equations = EquationsOf(About(middle, *runs[at]), options, form);
  for (std::size_t k = 0; k < options.shifted.size(); ++k) {
    const CircleRun shifted = About(middle, *options.shifted[k][at]);
    for (Eigen::Index i = 0; i < equations.radial.size(); ++i) {
      equations.instrument(i, k) = Radial(shifted.points[i], shifted.radius) - equations.radial[i];
    }
  }
  return equations;
}

struct Fit {
  estimation::Result result;
  // For each run: the deviations without the causes, their fitted smooth part (with the errors of
  // the instrument), and the residuals.
  std::vector<Eigen::VectorXd> unexplained, smooth, noise;
};

estimation::ParameterBlock SmoothBlock(const std::vector<double>& deviations) {
  estimation::ParameterBlock block{"smooth", {"um", 1e-6}, {}};
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const std::size_t order = kFirstHarmonic + k;
    block.entries.push_back({fmt::format("cos_{}", order), 0.0, deviations[k], 0.0});
    block.entries.push_back({fmt::format("sin_{}", order), 0.0, deviations[k], 0.0});
  }
  return block;
}

// The errors of the instrument, each in units of its standard deviation.
estimation::ParameterBlock InstrumentBlock(std::size_t directions) {
  estimation::ParameterBlock block{"instrument", {"", 1.0}, {}};
  for (std::size_t k = 0; k < directions; ++k) {
    block.entries.push_back({fmt::format("error_{}", k + 1), 0.0, 1.0, 0.0});
  }
  return block;
}

Fit Solve(const std::vector<Equations>& equations, const std::vector<Signature>& causes,
          const CauseOptions& options, double deviation) {
  Problem problem;
  estimation::ParameterBlock named{"cause", {"", 1.0}, {}};
  for (const Signature& cause : causes) {
    named.entries.push_back({Name(cause), 0.0, cause.usual, 0.0});
  }
  std::vector<estimation::Input> shared{problem.Add(std::move(named))};
  if (!options.smooth.empty()) shared.emplace_back(problem.Add(SmoothBlock(options.smooth)));
  if (!options.shifted.empty()) {
    shared.emplace_back(problem.Add(InstrumentBlock(options.shifted.size())));
  }
  for (std::size_t run = 0; run < equations.size(); ++run) {
    const Equations& one = equations[run];
    std::vector<estimation::Input> inputs = shared;
    inputs.emplace_back(
        problem.Add({fmt::format("centre_{}", run), {"um", 1e-6}, {{"first"}, {"second"}}}));
    Eigen::MatrixXd A(one.radial.size(), one.causes.cols() + one.smooth.cols() +
                                             one.instrument.cols() + one.centre.cols());
    A << one.causes, one.smooth, one.instrument, one.centre;
    problem.Add(problem.AddSource(fmt::format("run {}", run + 1)),
                std::make_shared<estimation::LinearResidual>(std::move(A), one.radial), inputs,
                deviation);
  }
  Fit fit{problem.Solve(), {}, {}, {}};
  if (!fit.result.Usable()) throw NumericalError(fit.result.WhyNotUsable());
  const auto part = [&fit](const Eigen::MatrixXd& columns, const std::string& block) {
    return columns.cols() == 0 ? Eigen::VectorXd::Zero(columns.rows()).eval()
                               : (columns * fit.result.Block(block).Values()).eval();
  };
  for (std::size_t run = 0; run < equations.size(); ++run) {
    const Equations& one = equations[run];
    fit.unexplained.emplace_back(one.radial - part(one.causes, "cause") -
                                 part(one.centre, fmt::format("centre_{}", run)));
    fit.smooth.emplace_back(part(one.smooth, "smooth") + part(one.instrument, "instrument"));
    fit.noise.emplace_back(fit.unexplained.back() - fit.smooth.back());
  }
  return fit;
}

Eigen::Index Rows(const std::vector<const CircleRun*>& runs) {
  Eigen::Index rows = 0;
  for (const CircleRun* run : runs) rows += std::ssize(run->points);
  return rows;
}

// The orders of smooth errors that so many points can show beside the causes and the centres.
void LimitOrders(const std::vector<const CircleRun*>& runs, std::size_t causes,
                 std::vector<double>& smooth) {
  const double rows = static_cast<double>(Rows(runs));
  const double named = static_cast<double>(causes + 2 * runs.size());
  if (rows < named + kLeastFreedom) {
    throw InputError(
        fmt::format("{}: {} points for the {} causes and centres of a circle; measure {} at least, "
                    "better a point every few degrees",
                    runs.front()->recordings.front(), rows, named, named + kLeastFreedom));
  }
  while (!smooth.empty() &&
         rows < kRowsOfParameter * (named + 2.0 * static_cast<double>(smooth.size()))) {
    smooth.pop_back();
  }
}

double Rms(const std::vector<Eigen::VectorXd>& residuals) {
  double squares = 0.0, n = 0.0;
  for (const Eigen::VectorXd& one : residuals) {
    squares += one.squaredNorm();
    n += one.size();
  }
  return std::sqrt(squares / n);
}

// Rows less the parameters that the data determine: 1 at least.
double FreedomOf(const Fit& fit, double rows) {
  return std::clamp(fit.result.redundancy, 1.0, rows);
}

// The factor by which the means of sectors scatter more than those of independent rows: at least 1.
double Correlated(const std::vector<const CircleRun*>& runs,
                  const std::vector<Eigen::VectorXd>& residuals, double rms) {
  double excess = 0.0, sectors = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::array<std::array<double, kSectors>, 2> sums{}, counts{};
    for (std::size_t i = 0; i < runs[r]->points.size(); ++i) {
      const CirclePoint& point = runs[r]->points[i];
      const double part = point.angle / (2 * std::numbers::pi) + 0.5;
      const std::size_t sector =
          std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, part) * kSectors));
      const std::size_t sense = point.sense > 0 ? 1 : 0;
      sums[sense][sector] += residuals[r][i];
      counts[sense][sector] += 1.0;
    }
    for (std::size_t sense = 0; sense < 2; ++sense) {
      for (std::size_t k = 0; k < kSectors; ++k) {
        if (counts[sense][k] == 0.0) continue;
        excess += sums[sense][k] * sums[sense][k] / counts[sense][k];
        sectors += 1.0;
      }
    }
  }
  return rms > 0.0 ? std::sqrt(std::max(1.0, excess / sectors / (rms * rms))) : 1.0;
}

// The data determine the parameter itself, not only a combination with another.
bool SeenByData(const estimation::Result& result, const std::string& name) {
  if (result.Seen(name) != estimation::SeenBy::kData) return false;
  const auto at = std::ranges::find(result.names, name) - result.names.begin();
  return std::ranges::none_of(result.weak_directions, [&](const estimation::WeakDirection& weak) {
    return std::abs(weak.coefficients[at]) > kLargePart;
  });
}

// The largest coefficient is that of a cause; directions of the nuisance parameters are of no
// interest.
bool IsOfCauses(const estimation::Result& result, const estimation::WeakDirection& weak) {
  Eigen::Index most = 0;
  weak.coefficients.cwiseAbs().maxCoeff(&most);
  return result.names[most].starts_with("cause.");
}

CircleCauses FitWith(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                     const BacklashForm& form) {
  std::vector<Signature> table = SignaturesOf(*runs.front(), options, form);
  std::erase_if(table, IsCentre);
  std::vector<Equations> equations;
  CircleCauses found;
  std::vector<Eigen::VectorXd> before;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    equations.push_back(CentredEquations(runs, run, options, form));
    const Eigen::VectorXd& radial = equations.back().radial;
    before.emplace_back(radial.array() - radial.mean());
  }
  found.rms_before = Rms(before);
  const Fit first = Solve(equations, table, options, kLeastRadialNoise);
  const double rows = static_cast<double>(Rows(runs));
  const double rms =
      std::max(Rms(first.noise) * std::sqrt(rows / FreedomOf(first, rows)), kLeastRadialNoise);
  found.correlated = Correlated(runs, first.noise, rms);
  const Fit fit = Solve(equations, table, options, rms * found.correlated);
  std::vector<Eigen::VectorXd> smooth;
  for (const Eigen::VectorXd& one : fit.smooth) smooth.emplace_back(one.array() - one.mean());
  found.rms_smooth = Rms(smooth);  // a longer ballbar is no error of the machine
  found.rms_after = Rms(fit.noise);
  found.covariance = fit.result.Covariance("cause", "cause");
  const double independent = rows / (found.correlated * found.correlated);
  found.freedom = std::max(independent - (rows - FreedomOf(fit, rows)), 1.0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string name = "cause." + Name(table[i]);
    CauseEstimate estimate{table[i].cause, table[i].object, table[i].unit, fit.result.Value(name),
                           fit.result.Uncertainty(name)};
    for (const Equations& one : equations) {
      estimate.effect = std::max(
          estimate.effect, std::abs(estimate.value) * one.causes.col(i).cwiseAbs().maxCoeff());
    }
    estimate.seen = SeenByData(fit.result, name);
    found.causes.push_back(std::move(estimate));
  }
  for (const auto& weak : fit.result.weak_directions) {
    if (IsOfCauses(fit.result, weak)) found.weak_directions.push_back(weak.words);
  }
  for (const Eigen::VectorXd& one : fit.unexplained) {
    found.residuals.emplace_back(one.begin(), one.end());
  }
  return found;
}

std::array<double, 2> BacklashOf(const CircleCauses& found) {
  std::array<double, 2> backlash{};
  std::size_t axis = 0;
  for (const CauseEstimate& one : found.causes) {
    if (one.cause == "backlash") backlash[axis++] = std::abs(one.value);
  }
  return backlash;
}

// The fits with all ways in which backlash may be taken up.
std::vector<CircleCauses> FitWithAll(const std::vector<const CircleRun*>& runs,
                                     const CauseOptions& options) {
  constexpr int kRounds = 4;  // each brings the way closer to the play by a factor of five
  constexpr std::array kWays{0.5e-6, 1e-6,  2e-6,   5e-6,   10e-6,
                             20e-6,  50e-6, 100e-6, 200e-6, 500e-6};  // m
  std::vector<CircleCauses> fits{FitWith(runs, options, {})};
  CircleCauses with_play = fits.front();
  for (int round = 0; round < kRounds; ++round) {
    with_play = FitWith(runs, options, {standards::TakenUp::kWithPlay, BacklashOf(with_play)});
  }
  fits.push_back(std::move(with_play));
  for (const double way : kWays) {
    fits.push_back(FitWith(runs, options, {standards::TakenUp::kByWindUp, {way, way}}));
  }
  return fits;
}

// The logarithm of the marginal likelihood of a fit, up to what is the same for all. `rows`:
// independent ones.
double LogLikelihood(const CircleCauses& fit, double rows) {
  return -rows * std::log(std::max(fit.rms_after, kLeastRadialNoise));
}

Eigen::VectorXd ValuesOf(const CircleCauses& fit) {
  Eigen::VectorXd values(fit.causes.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = fit.causes[i].value;
  return values;
}

}  // namespace

CircleCauses FitCircleCauses(const std::vector<const CircleRun*>& runs, CauseOptions options) {
  CheckCircles(runs);
  LimitOrders(
      runs, std::ranges::count_if(SignaturesOf(*runs.front(), options, {}), std::not_fn(IsCentre)),
      options.smooth);
  std::vector<CircleCauses> fits = FitWithAll(runs, options);
  CircleCauses& best = *std::ranges::min_element(fits, {}, &CircleCauses::rms_after);
  const double rows = static_cast<double>(Rows(runs)) / (best.correlated * best.correlated);
  const double most = LogLikelihood(best, rows);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(std::ssize(best.causes));
  double sum = 0.0;
  for (const CircleCauses& fit : fits) {
    const double weight = std::exp(LogLikelihood(fit, rows) - most);
    mean += weight * ValuesOf(fit);
    sum += weight;
  }
  mean /= sum;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mean.size(), mean.size());
  for (const CircleCauses& fit : fits) {
    const Eigen::VectorXd off = ValuesOf(fit) - mean;
    const double weight = std::exp(LogLikelihood(fit, rows) - most) / sum;
    covariance += weight * (fit.covariance + off * off.transpose());
  }
  // The noise is known to so many degrees of freedom: 2 u is a U95 for all.
  const double t = standards::StudentWidening(best.freedom);
  covariance *= t * t;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    CauseEstimate& one = best.causes[i];
    if (one.value != 0.0) one.effect *= std::abs(mean[i] / one.value);
    one.value = mean[i];
    one.u = std::sqrt(covariance(i, i));
  }
  best.covariance = std::move(covariance);
  return std::move(best);
}

}  // namespace abbe::fusion
