#include "simulation/causes/cause.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe::simulation {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

bool Scene::HasSweeps() const {
  return std::any_of(traces.begin(), traces.end(),
                     [](const Trace* trace) { return trace->head.has_value(); });
}

bool Scene::OnlyShafts() const {
  return !traces.empty() && std::all_of(traces.begin(), traces.end(),
                                        [](const Trace* trace) { return trace->rim.has_value(); });
}

bool Scene::HasArms() const {
  return std::any_of(traces.begin(), traces.end(),
                     [](const Trace* trace) { return trace->linkage && trace->linkage->is_arm; });
}

Eigen::Index Scene::Pivots() const {
  Eigen::Index pivots = 0;
  for (const Trace* trace : traces) pivots = std::max(pivots, trace->pivots());
  return pivots;
}

std::vector<std::string> Scene::Sensors() const {
  std::vector<std::string> sensors;
  for (const Trace* trace : traces) {
    for (const std::string& sensor : trace->sensors) {
      if (std::find(sensors.begin(), sensors.end(), sensor) == sensors.end()) {
        sensors.push_back(sensor);
      }
    }
  }
  return sensors;
}

double Wave::WavesOf(double of_shape) const {
  switch (shape) {
    case Shape::kPeriod:
      return 1.0 / of_shape;
    case Shape::kOrder:
      return of_shape / (2.0 * std::numbers::pi);
    case Shape::kFrequency:
      break;
  }
  return of_shape;
}

double Wave::ShapeOf(double waves) const {
  switch (shape) {
    case Shape::kPeriod:
      return 1.0 / waves;
    case Shape::kOrder:
      return std::round(2.0 * std::numbers::pi * waves);
    case Shape::kFrequency:
      break;
  }
  return waves;
}

std::vector<VectorXd> Cause::ShapesFor(const Scene& scene, const Object& object) const {
  if (shapes_of) return shapes_of(scene, object);
  return shapes ? shapes(scene) : std::vector<VectorXd>{VectorXd()};
}

VectorXd Cause::ValuesOf(const VectorXd& found, const VectorXd& shape) const {
  if (tell) return tell(found, shape);
  const Eigen::Index fixed =
      FollowsItsSize() ? std::max<Eigen::Index>(shape.size() - found.size(), 0) : shape.size();
  VectorXd values(found.size() + fixed);
  values << found, shape.head(fixed);
  return values;
}

std::optional<std::size_t> Cause::KeyOfShape() const {
  constexpr double kMark = 42.0;
  if (!shapes || FollowsItsSize() || IsRandomField()) return {};
  const VectorXd values = ValuesOf(VectorXd::Zero(coefficients()), VectorXd::Constant(1, kMark));
  const auto at = std::find(values.begin(), values.end(), kMark);
  if (at == values.end()) return {};
  return at - values.begin();
}

Recalled Cause::RecallFrom(const VectorXd& values) const {
  if (IsBinary()) return {VectorXd::Ones(1), {}};
  if (recall) return recall(values);
  const VectorXd sizes = values.head(coefficients()),
                 rest = values.tail(values.size() - sizes.size());
  return {sizes, FollowsItsSize() ? AroundSizes(rest, sizes) : rest};
}

CorrectedBy Cause::CorrectedAt(const Object& object) const {
  if (in_map) return CorrectedBy::kMap;
  if (seat) return *seat;
  return object.IsOfAxes() ? CorrectedBy::kMotion : CorrectedBy::kInstrument;
}

std::vector<Object> AxesOf(const Scene& scene) {
  if (scene.OnlyShafts()) return {};
  return {"X", "Y", "Z"};
}

std::vector<Object> AxisPairsOf(const Scene& scene) {
  if (scene.OnlyShafts()) return {};
  return {"XY", "XZ", "YZ"};
}

std::vector<Object> ProbesOf(const Scene& scene) {
  if (!scene.HasSweeps()) return {};
  return {"probe_a", "probe_b", "probe_c", "probe_d", "probe_e"};
}

std::vector<Object> PivotsOf(const Scene& scene) {
  std::vector<Object> pivots;
  for (Eigen::Index i = 1; i <= scene.Pivots(); ++i)
    pivots.emplace_back("pivot_" + std::to_string(i));
  return pivots;
}

std::vector<Object> JointsOfArms(const Scene& scene) {
  return scene.HasArms() ? PivotsOf(scene) : std::vector<Object>{};
}

std::vector<Object> ArmOf(const Scene& scene) {
  return scene.HasArms() ? std::vector<Object>{"arm"} : std::vector<Object>{};
}

int Positioning(int axis) { return MotionStage(axis, axis); }

VectorXd AroundSizes(const VectorXd& fixed, const VectorXd& sizes) {
  VectorXd shape(fixed.size() + sizes.size());
  shape << fixed, sizes;
  return shape;
}

double SizeOf(const VectorXd& shape) { return shape.size() == 0 ? 0.0 : shape[0]; }

Disturbance InStage(const Trace& trace, Eigen::Index stage, const RowVectorXd& values) {
  Disturbance disturbance = NoDisturbance(trace);
  disturbance.row(stage) = values;
  return disturbance;
}

std::vector<Disturbance> WaveInStage(const Trace& trace, Eigen::Index stage,
                                     const RowVectorXd& phase) {
  return {InStage(trace, stage, phase.array().sin()), InStage(trace, stage, phase.array().cos())};
}

// A sum of evenly spaced phases is that in the middle, times Dirichlet's kernel.
std::vector<Disturbance> LineInStage(const Trace& trace, Eigen::Index stage, double frequency,
                                     const VectorXd& clock) {
  const double turn = 2.0 * std::numbers::pi * frequency;
  auto waves = WaveInStage(trace, stage, turn * clock.transpose());
  for (Eigen::Index row = 0; row < trace.samples.size(); ++row) {
    const double n = trace.samples[row];
    if (n <= 1.0) continue;
    const double half = 0.5 * turn * trace.duration[row] / (n - 1.0), sine = std::sin(half);
    const double kept = std::abs(sine) < 1e-9 ? std::cos(n * half) / std::cos(half)
                                              : std::sin(n * half) / (n * sine);
    for (Disturbance& wave : waves) wave.row(stage)[row] *= kept;
  }
  return waves;
}

// amplitude sin(t + phase) = amplitude cos(phase) sin t + amplitude sin(phase) cos t
Eigen::Vector2d AmplitudeAndPhase(const VectorXd& sine_cosine) {
  return {sine_cosine.norm(), std::atan2(sine_cosine[1], sine_cosine[0])};
}

Eigen::Vector2d SineAndCosine(double amplitude, double phase) {
  return {amplitude * std::cos(phase), amplitude * std::sin(phase)};
}

std::vector<VectorXd> ShapesOf(const std::vector<double>& numbers) {
  std::vector<VectorXd> shapes;
  shapes.reserve(numbers.size());
  for (const double number : numbers) shapes.push_back(VectorXd::Constant(1, number));
  return shapes;
}

std::vector<VectorXd> GeometricShapes(double first, double last, double ratio) {
  std::vector<double> numbers;
  for (double number = first; number <= last; number *= ratio) numbers.push_back(number);
  return ShapesOf(numbers);
}

}  // namespace abbe::simulation
