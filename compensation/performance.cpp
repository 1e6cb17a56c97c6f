#include "compensation/performance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "compensation/test_pieces.h"
#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::compensation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// A root A of the covariance, A A^T = cov, which may be singular: held parameters do not vary.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& cov) {
  const Eigen::VectorXd size = cov.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = size.unaryExpr([](double s) { return s > 0.0 ? 1 / s : 0.0; });
  const Eigen::MatrixXd correlation = scale.asDiagonal() * cov * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
  return size.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

using MakePiece = PerformanceTest (*)(const Volume&, const TestSize&);
constexpr std::array<std::pair<std::string_view, MakePiece>, 6> kTests = {
    {{"length", Lengths},
     {"circle", Circles},
     {"square", Squares},
     {"cylinder", Cylinder},
     {"freeform", Freeform},
     {"diagonals", Diagonals}}};

}  // namespace

std::vector<std::string_view> TestNames() {
  std::vector<std::string_view> names;
  names.reserve(kTests.size());
  for (const auto& [name, make] : kTests) names.push_back(name);
  return names;
}

PerformanceTest MakeTest(std::string_view name, const map::ErrorMap& map, const TestSize& size) {
  constexpr double kUsed = 0.98;
  Volume volume;
  for (int k = 0; k < 3; ++k) {
    const machine::Travel& travel = map.model().travels()[k];
    volume.middle[k] = (travel.first + travel.last) / 2;
    volume.half[k] = kUsed * (travel.last - travel.first) / 2;
  }
  for (const auto& [known, make] : kTests) {
    if (known == name) return make(volume, size);
  }
  throw InputError(
      fmt::format("\"{}\" is not a test; write {}", name, fmt::join(TestNames(), ", ")));
}

Matrix3Xd MadeBy(const machine::VolumetricModel& machine, const Vector3d& p_TQ,
                 const Matrix3Xd& commands) {
  const Corrector corrector(machine, p_TQ);
  Matrix3Xd made(3, commands.cols());
  for (Index i = 0; i < commands.cols(); ++i) made.col(i) = corrector.Made(commands.col(i));
  return made;
}

std::vector<Figure> AfterCorrection(const map::ErrorMap& map, const Vector3d& p_TQ,
                                    const PerformanceTest& test, int draws, std::uint64_t seed) {
  if (!map.StatesUncertainty()) {
    throw InputError(
        "this map has no uncertainty, which determines the error after correction; "
        "fuse the runs again to get one");
  }
  if (draws < 20) throw InputError(fmt::format("{} draws: give 20 or more", draws));
  const Corrector corrector(map, p_TQ);
  Matrix3Xd commands(3, test.wanted.cols());
  for (Index i = 0; i < commands.cols(); ++i) {
    commands.col(i) = corrector.Command(test.wanted.col(i));
  }
  const Eigen::MatrixXd root = RootOf(map.cov_pp());
  const Eigen::VectorXd parameters = map.model().Parameters();
  machine::VolumetricModel drawn = map.model();
  std::vector<Figure> figures;
  std::vector<std::vector<double>> sizes;
  for (int draw = 0; draw < draws; ++draw) {
    const random::CounterRandom random(seed, draw);
    Eigen::VectorXd normals(parameters.size());
    for (Index i = 0; i < normals.size(); ++i) {
      normals[i] = random.Normal(i);
    }
    drawn.SetParameters(parameters + root * normals);
    figures = test.evaluate(MadeBy(drawn, p_TQ, commands));
    sizes.resize(figures.size());
    for (std::size_t i = 0; i < figures.size(); ++i) sizes[i].push_back(std::abs(figures[i].value));
  }
  for (std::size_t i = 0; i < figures.size(); ++i) {
    std::sort(sizes[i].begin(), sizes[i].end());
    figures[i].value = sizes[i][static_cast<std::size_t>(std::ceil(0.95 * draws)) - 1];
  }
  return figures;
}

}  // namespace abbe::compensation
