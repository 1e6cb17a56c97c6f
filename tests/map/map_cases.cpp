#include "map_cases.h"

#include <Eigen/Cholesky>
#include <vector>

#include "machine/tanh_network.h"

namespace abbe::map {
namespace {

using machine::VolumetricModel;

constexpr double kTravel = 0.060;

Eigen::VectorXd Normals(std::uint64_t seed, std::uint64_t stream, Eigen::Index count) {
  const random::CounterRandom random(seed, stream);
  Eigen::VectorXd numbers(count);
  for (Eigen::Index i = 0; i < count; ++i) numbers[i] = random.Normal(i);
  return numbers;
}

// 2 um for translations, 20 urad for turns.
double SizeOf(int motion) { return motion < 3 ? 2e-6 : 20e-6; }

void Draw(VolumetricModel& model, std::uint64_t seed) {
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto stream = static_cast<std::uint64_t>(10 + machine::kMotions * axis + motion);
      model.SetCoefficients(
          axis, motion,
          SizeOf(motion) * Normals(seed, stream, model.Function(axis, motion).size()));
    }
  }
  model.SetSquareness(30e-6 * Normals(seed, 1, 3));
}

// relative^2 D (I + v v^T / n) D with D the sizes of the parameters.
Eigen::MatrixXd CovarianceFor(const VolumetricModel& model, std::uint64_t seed, double relative) {
  const Eigen::Index count = model.ParameterCount();
  Eigen::VectorXd size(count);
  Eigen::Index at = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const int n = model.Function(axis, motion).size();
      size.segment(at, n).setConstant(relative * SizeOf(motion));
      at += n;
    }
  }
  size.tail<3>().setConstant(relative * 30e-6);
  const Eigen::VectorXd v = Normals(seed, 2, count);
  Eigen::MatrixXd shape =
      Eigen::MatrixXd::Identity(count, count) + v * v.transpose() / static_cast<double>(count);
  Eigen::MatrixXd cov = size.asDiagonal() * shape * size.asDiagonal();
  return (cov + cov.transpose()) / 2;
}

MapOrigin OriginFor(std::uint64_t seed) {
  MapOrigin origin;
  origin.machine = "mill \"7\"";
  origin.reference = {0.001, -0.002, 0.1};
  origin.tool = {0.01, -0.02, -0.08 - 1e-3 / 3};
  origin.temperature = 20.1;
  origin.scale_is_calibrated = seed % 2 == 1;
  for (std::size_t i = 0; i < origin.sources.size(); ++i) {
    constexpr std::array kKinds{"", "sweep", "linkage", "gap-steps"};
    origin.sources[i] = kKinds[(i + seed) % kKinds.size()];
  }
  origin.sources[17] = {};  // ECZ, which MapOfAllForms leaves out and the file with it
  return origin;
}

}  // namespace

ErrorMap RandomMap(std::uint64_t seed, const char* chain, double relative) {
  VolumetricModel model(machine::Chain::Parse(chain), {{{0, kTravel}, {0, kTravel}, {0, kTravel}}});
  const auto form = machine::MakeBSplineForm(geometry::BSplineBasis::Uniform(3, 0.0, kTravel, 8));
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) model.SetForm(axis, motion, form);
  }
  Draw(model, seed);
  Eigen::MatrixXd cov = CovarianceFor(model, seed, relative);
  return {OriginFor(seed), std::move(model), std::move(cov)};
}

ErrorMap MapOfAllForms(std::uint64_t seed) {
  using namespace machine;
  const std::array<Travel, kAxes> travels = {{{-0.1, 0.2}, {0.0, 0.11}, {-0.3, -0.1}}};
  VolumetricModel model(Chain::Parse(kBridge), travels);
  for (int axis = 0; axis < kAxes; ++axis) {
    const double a = travels[axis].first, b = travels[axis].last;
    const std::vector<SharedForm> forms = {
        MakeBSplineForm(geometry::BSplineBasis::Uniform(4, a, b, 9)),
        MakeTableForm({a, (2 * a + b) / 3, b}),
        MakePolynomialForm(5, a, b),
        MakeFourierForm(3, (b - a) * 0.7),
        MakeTanhNetwork(2, 2 / (b - a), NetworkBias::kAsPrinted),
        MakeTanhNetwork(3, 3 / (b - a), NetworkBias::kWithBias)};
    for (int motion = 0; motion < kMotions; ++motion) {
      const bool is_left_out = axis == 2 && motion == 5;
      if (!is_left_out) model.SetForm(axis, motion, forms[(motion + axis) % forms.size()]);
    }
  }
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const auto stream = static_cast<std::uint64_t>(10 + kMotions * axis + motion);
      model.SetCoefficients(axis, motion,
                            1e-5 * Normals(seed, stream, model.Function(axis, motion).size()));
    }
  }
  model.SetSquareness(30e-6 * Normals(seed, 1, 3));
  Eigen::MatrixXd cov = CovarianceFor(model, seed, 0.1);
  return {OriginFor(seed), std::move(model), std::move(cov)};
}

Eigen::Vector3d RandomPlace(const ErrorMap& map, std::uint64_t seed, std::uint64_t index) {
  Eigen::Vector3d place;
  for (int k = 0; k < 3; ++k) {
    const machine::Travel& travel = map.model().travels()[k];
    place[k] = random::CounterRandom(seed, 90 + k).Uniform(index, travel.first, travel.last);
  }
  return place;
}

Eigen::VectorXd DrawParameters(const ErrorMap& map, std::uint64_t seed) {
  const Eigen::LLT<Eigen::MatrixXd> root(map.cov_pp());
  return map.model().Parameters() + root.matrixL() * Normals(seed, 3, map.cov_pp().rows());
}

}  // namespace abbe::map
