#include "fusion/circle_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "estimation/linearization.h"
#include "estimation/noise_memory.h"
#include "estimation/problem.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "fusion/reversal_shapes.h"
#include "fusion/row_memory.h"

namespace abbe::fusion {
namespace {

using estimation::Problem;
using paths::CirclePoint;
using paths::CircleRun;
using standards::Signature;

bool IsCentre(const Signature& signature) { return signature.cause == "centre"; }

std::vector<Signature> SignaturesOf(const CircleRun& run, const CauseOptions& options,
                                    const ReversalForm& form) {
  return standards::CircleSignatures({.first = run.plane.name[0],
                                      .second = run.plane.name[1],
                                      .first_centre = run.plane.first.dot(run.centre),
                                      .second_centre = run.plane.second.dot(run.centre),
                                      .pitch = options.pitch,
                                      .spike = form.spike,
                                      .taken_up = form.how,
                                      .way = form.way});
}

double Radial(const CirclePoint& point, double radius) {
  return std::hypot(point.first, point.second) - radius;
}

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

Eigen::VectorXd Travelled(const CircleRun& run) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  Eigen::VectorXd travelled = Eigen::VectorXd::Zero(std::ssize(run.points));
  for (Eigen::Index i = 1; i < travelled.size(); ++i) {
    const CirclePoint &point = run.points[i], &before = run.points[i - 1];
    const bool goes_on = point.sense == before.sense && point.pass == before.pass;
    const double step = std::abs(std::remainder(point.angle - before.angle, kTurn));
    travelled[i] = travelled[i - 1] + step + (goes_on ? 0.0 : kTurn);
  }
  return travelled;
}

CircleEquations EquationsOf(const CircleRun& run, const CauseOptions& options,
                            const ReversalForm& form) {
  const std::vector<Signature> table = SignaturesOf(run, options, form);
  const Eigen::Index n = run.points.size();
  const auto centres = std::ranges::count_if(table, IsCentre);
  CircleEquations equations{Eigen::MatrixXd(n, centres),
                            Eigen::MatrixXd(n, table.size() - centres),
                            Waves(run, options.smooth.size()),
                            Eigen::MatrixXd(n, options.shifted.size()),
                            {},
                            {},
                            {},
                            {},
                            Eigen::VectorXd(n),
                            Travelled(run)};
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

// Those of one cause, one an axis.
Eigen::MatrixXd OfBothAxes(const std::string& of, const Eigen::MatrixXd& causes,
                           const std::vector<Signature>& table) {
  Eigen::MatrixXd columns(causes.rows(), 2);
  for (Eigen::Index cause = 0, axis = 0; cause < causes.cols(); ++cause) {
    if (table[cause].cause == of) columns.col(axis++) = causes.col(cause);
  }
  return columns;
}

AfterReversals AfterReversalsOf(const CircleRun& run, const ReversalForm& form) {
  return {form.spike_size, {form.spike.WidthAt(run.feed, 0), form.spike.WidthAt(run.feed, 1)}};
}

Eigen::MatrixXd SpikesOf(const CircleEquations& equations, const std::vector<Signature>& table) {
  return OfBothAxes("reversal_spike", equations.causes, table);
}

// The derivatives of the deviations with respect to the logarithms of the way and of the width of
// the spikes of each axis.
Eigen::MatrixXd ByLogarithms(const CircleRun& run, const CauseOptions& options,
                             const ReversalForm& form) {
  constexpr double kStep = 0.01;
  const auto stepped = [&](double step) {
    ReversalForm changed = form;
    for (double& way : changed.way) way *= std::exp(step);
    for (double& width : changed.spike.width) width *= std::exp(step);
    const std::vector<Signature> table = CausesOf(run, options, changed);
    const Eigen::MatrixXd causes = EquationsOf(run, options, changed).causes;
    Eigen::MatrixXd columns(causes.rows(), 4);
    columns << OfBothAxes("backlash", causes, table), OfBothAxes("reversal_spike", causes, table);
    return columns;
  };
  const Eigen::MatrixXd slopes = (stepped(kStep) - stepped(-kStep)) / (2.0 * kStep);
  const Eigen::Vector4d sizes(form.wound_up[0], form.wound_up[1], form.spread[0], form.spread[1]);
  return slopes * sizes.asDiagonal();
}

estimation::ParameterBlock SmoothBlock(const std::vector<double>& deviations) {
  estimation::ParameterBlock block{"smooth", {"um", 1e-6}, {}};
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const std::size_t order = kFirstHarmonic + k;
    block.entries.push_back({fmt::format("cos_{}", order), 0.0, deviations[k], 0.0});
    block.entries.push_back({fmt::format("sin_{}", order), 0.0, deviations[k], 0.0});
  }
  return block;
}

// Each in units of its standard deviation.
estimation::ParameterBlock UnitBlock(const std::string& name, Eigen::Index count) {
  estimation::ParameterBlock block{name, {"", 1.0}, {}};
  for (Eigen::Index k = 0; k < count; ++k) {
    block.entries.push_back({fmt::format("{}", k + 1), 0.0, 1.0, 0.0});
  }
  return block;
}

// Rows less what they remember of those before, over the noise of their run.
void Whiten(const CircleNoise& noise, std::size_t run, const Eigen::VectorXd& travelled,
            Eigen::Ref<Eigen::MatrixXd> columns) {
  if (noise.memory.empty()) return;
  estimation::MemoryFilter(travelled, noise.memory[run]).Whiten(columns);
}

// A source for each run.
Problem CircleProblem(const std::vector<CircleEquations>& equations,
                      const std::vector<Signature>& causes, const CauseOptions& options,
                      const CircleNoise& noise) {
  Problem problem;
  estimation::ParameterBlock named{"cause", {"", 1.0}, {}};
  for (const Signature& cause : causes) {
    named.entries.push_back({CauseName(cause), 0.0, cause.usual, 0.0});
  }
  std::vector<estimation::Input> shared{problem.Add(std::move(named))};
  if (!options.smooth.empty()) shared.emplace_back(problem.Add(SmoothBlock(options.smooth)));
  if (!options.shifted.empty()) {
    shared.emplace_back(problem.Add(UnitBlock("instrument", std::ssize(options.shifted))));
  }
  const bool spikes = equations.front().shapes.size() > 0;
  if (equations.front().between.size() > 0) {
    shared.emplace_back(problem.Add(UnitBlock("between", equations.front().between.cols())));
  }
  if (spikes) {
    shared.emplace_back(problem.Add(UnitBlock("alike", equations.front().alike.cols())));
  }
  if (equations.front().ways.size() > 0)
    shared.emplace_back(problem.Add(UnitBlock("ways", equations.front().ways.cols())));
  for (std::size_t run = 0; run < equations.size(); ++run) {
    const CircleEquations& one = equations[run];
    std::vector<estimation::Input> inputs = shared;
    inputs.emplace_back(
        problem.Add({fmt::format("centre_{}", run), {"um", 1e-6}, {{"first"}, {"second"}}}));
    if (spikes) {
      inputs.emplace_back(problem.Add(UnitBlock(fmt::format("shapes_{}", run), one.shapes.cols())));
    }
    Eigen::MatrixXd A(one.radial.size(), 0);
    for (const auto* part : {&one.causes, &one.smooth, &one.instrument, &one.between, &one.alike,
                             &one.ways, &one.centre, &one.shapes}) {
      if (part->cols() == 0) continue;
      A.conservativeResize(Eigen::NoChange, A.cols() + part->cols());
      A.rightCols(part->cols()) = *part;
    }
    Eigen::VectorXd b = one.radial;
    Whiten(noise, run, one.travelled, A);
    Whiten(noise, run, one.travelled, b);
    problem.Add(problem.AddSource(fmt::format("run {}", run + 1)),
                std::make_shared<estimation::LinearResidual>(std::move(A), std::move(b)), inputs,
                noise.deviation);
  }
  return problem;
}

}  // namespace

std::string CauseName(const Signature& cause) { return cause.cause + "." + cause.object; }

std::vector<Signature> CausesOf(const CircleRun& run, const CauseOptions& options,
                                const ReversalForm& form) {
  std::vector<Signature> table = SignaturesOf(run, options, form);
  std::erase_if(table, IsCentre);
  return table;
}

CircleEquations CentredEquations(const std::vector<const CircleRun*>& runs, std::size_t at,
                                 const CauseOptions& options, const ReversalForm& form) {
  const Eigen::Vector2d middle = runs[at]->middle;
  const CircleRun centred = About(middle, *runs[at]);
  CircleEquations equations = EquationsOf(centred, options, form);
  for (std::size_t k = 0; k < options.shifted.size(); ++k) {
    const CircleRun shifted = About(middle, *options.shifted[k][at]);
    for (Eigen::Index i = 0; i < equations.radial.size(); ++i) {
      equations.instrument(i, k) = Radial(shifted.points[i], shifted.radius) - equations.radial[i];
    }
  }
  if (form.spike_size != std::array<double, 2>{}) {
    const Eigen::MatrixXd spikes = SpikesOf(equations, CausesOf(centred, options, form));
    const AfterReversals after = AfterReversalsOf(centred, form);
    equations.shapes = ShapesOf(centred, spikes, after);
    equations.alike = ShapesAlike(centred, after);
    equations.between = SpikesBetweenRuns(spikes, at, runs.size(), after);
  }
  if (const std::array<double, 2> none{}; form.wound_up != none || form.spread != none) {
    equations.ways = ByLogarithms(centred, options, form);
  }
  return equations;
}

CircleEquations SpikesOnGrid(const CircleRun& run, const CauseOptions& options,
                             const ReversalForm& form) {
  constexpr int kPoints = 3600;
  CircleRun grid = run;
  grid.points.clear();
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoints;
    grid.points.push_back(
        {run.radius * std::cos(angle), run.radius * std::sin(angle), 0.0, angle, 1, 1});
  }
  CircleEquations equations = EquationsOf(grid, options, form);
  equations.alike = ShapesAlike(grid, AfterReversalsOf(grid, form));
  return equations;
}

CircleFit SolveCircles(const std::vector<CircleEquations>& equations,
                       const std::vector<Signature>& causes, const CauseOptions& options,
                       const CircleNoise& noise) {
  const Problem problem = CircleProblem(equations, causes, options, noise);
  CircleFit fit{problem.Solve(), {}, {}, {}, {}, {}, {}};
  if (!fit.result.Usable()) throw NumericalError(fit.result.WhyNotUsable());
  const auto without = [&fit](const Eigen::MatrixXd& columns, const std::string& block,
                              Eigen::VectorXd& left) {
    if (columns.cols() > 0) left -= columns * fit.result.Block(block).Values();
  };
  for (std::size_t run = 0; run < equations.size(); ++run) {
    const CircleEquations& one = equations[run];
    Eigen::VectorXd& left = fit.unexplained.emplace_back(one.radial);
    without(one.causes, "cause", left);
    without(one.between, "between", left);
    without(one.alike, "alike", left);
    without(one.ways, "ways", left);
    without(one.shapes, fmt::format("shapes_{}", run), left);
    without(one.centre, fmt::format("centre_{}", run), left);
    Eigen::VectorXd& residuals = fit.noise.emplace_back(left);
    without(one.smooth, "smooth", residuals);
    without(one.instrument, "instrument", residuals);
    fit.smooth.emplace_back(left - residuals);
    Whiten(noise, run, one.travelled, fit.white.emplace_back(residuals));
  }
  for (const estimation::ParameterBlock& block : problem.blocks()) {
    if (block.name == "alike" || block.name == "between" || block.name.starts_with("shapes_")) {
      fit.improbable += 0.5 * fit.result.Block(block.name).Values().squaredNorm();
    }
  }
  if (equations.front().ways.size() > 0) {
    const Eigen::VectorXd more = fit.result.Block("ways").Values();
    fit.longer = {more[0], more[1]};
    fit.wider = {more[2], more[3]};
  }
  return fit;
}

CircleMemory MemoryOf(const std::vector<CircleEquations>& equations,
                      const std::vector<Signature>& causes, const CauseOptions& options,
                      double deviation) {
  const Problem problem = CircleProblem(equations, causes, options, {deviation, {}});
  const estimation::Layout layout(problem);
  estimation::Linearization at;
  const estimation::Result result = problem.Solve({}, &at);
  const Eigen::VectorXd x = ValuesFound(result, result.blocks);
  CircleMemory memory;
  bool any = false;
  for (std::size_t run = 0; run < equations.size(); ++run) {
    const RowMemory found = FindRowMemory(problem, layout, x, at, run, equations[run].travelled);
    any |= found.IsDrift();
    const double rows = static_cast<double>(equations[run].radial.size());
    const double scatter = std::sqrt(result.sources[run].chi_square / rows);
    memory.push_back(found.IsDrift() ? found.noise : estimation::NoiseMemory{scatter, 0.0, 1.0});
  }
  return any ? memory : CircleMemory{};
}

}  // namespace abbe::fusion
