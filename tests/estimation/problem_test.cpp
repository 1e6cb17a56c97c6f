#include "estimation/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "estimation/autodiff_residual.h"
#include "failure/failure.h"
#include "failure/interruption.h"
#include "linear_case.h"

namespace abbe::estimation {
namespace problem_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::HasSubstr;

// A residual written in place.
class Written : public Residual {
 public:
  using Body = std::function<void(const VectorXd&, VectorXd&, RowMatrix*)>;
  Written(Eigen::Index rows, Body body) : rows_(rows), body_(std::move(body)) {}
  Eigen::Index Rows() const override { return rows_; }
  void Evaluate(const VectorXd& x, VectorXd& values, RowMatrix* jacobian) const override {
    body_(x, values, jacobian);
  }

 private:
  Eigen::Index rows_;
  Body body_;
};

template <class Failure>
std::string Words(const std::function<void()>& act) {
  try {
    act();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "nothing was thrown";
}

// Two blocks, two sources, priors on some entries: the Bayes update is a closed form.
TEST(Problem, LinearFitWithPriorsIsTheBayesUpdate) {
  const MatrixXd a = RandomMatrix(20, 3, 1), b = RandomMatrix(15, 5, 2);
  const VectorXd ya = RandomMatrix(20, 1, 3), yb = RandomMatrix(15, 1, 4);
  VectorXd sd = VectorXd::LinSpaced(15, 0.1, 2.0);
  Problem problem;
  ParameterBlock first = Block("first", {"a", "b", "c"});
  first["b"] = {"b", 0.3, 0.05};
  ParameterBlock second = Block("second", {"d", "e"}, 0.2);
  const BlockId one = problem.Add(first), two = problem.Add(second);
  problem.Add(problem.AddSource("gauge"), Linear(a, ya), {one}, 0.5);
  problem.Add(problem.AddSource("probe"), Linear(b, yb), {two, one}, sd);
  const Result result = problem.Solve();

  MatrixXd j = MatrixXd::Zero(38, 5);  // rows of both sources, then the three priors
  VectorXd y(38);
  j.topLeftCorner(20, 3) = a / 0.5;
  y.head(20) = ya / 0.5;
  const VectorXd w = sd.cwiseInverse();
  j.block(20, 0, 15, 3) = w.asDiagonal() * b.rightCols(3);
  j.block(20, 3, 15, 2) = w.asDiagonal() * b.leftCols(2);
  y.segment(20, 15) = w.cwiseProduct(yb);
  j(35, 1) = 1 / 0.05;
  j(36, 3) = j(37, 4) = 1 / 0.2;
  y.tail(3) << 0.3 / 0.05, 0.0, 0.0;
  const VectorXd x = j.colPivHouseholderQr().solve(y);
  const MatrixXd covariance = (j.transpose() * j).inverse();
  const VectorXd r = j * x - y;

  constexpr double kRounding = 1e-12;  // condition below 1e2, twice
  ASSERT_TRUE(result.Usable());
  EXPECT_NEAR(result.Value("first.a"), x[0], kRounding);
  EXPECT_NEAR(result.Value("second.e"), x[4], kRounding);
  EXPECT_NEAR(result.Uncertainty("first.b"), std::sqrt(covariance(1, 1)), kRounding);
  EXPECT_LT((result.covariance - covariance).norm(), kRounding);
  EXPECT_LT((result.Covariance("second", "first") - covariance.bottomLeftCorner(2, 3)).norm(),
            kRounding);
  EXPECT_NEAR(result.Correlation("first.a", "second.d"),
              covariance(0, 3) / std::sqrt(covariance(0, 0) * covariance(3, 3)), kRounding);
  EXPECT_NEAR(result.Source("gauge").chi_square, r.head(20).squaredNorm(), 1e-10);
  EXPECT_NEAR(result.Source("probe").chi_square, r.segment(20, 15).squaredNorm(), 1e-10);
  EXPECT_NEAR(result.Source("prior").chi_square, r.tail(3).squaredNorm(), 1e-10);
  const MatrixXd hat = j * covariance * j.transpose();
  EXPECT_NEAR(result.Source("gauge").redundancy, 20 - hat.topLeftCorner(20, 20).trace(), 1e-10);
  double redundancy = 0.0;
  for (const SourceResult& source : result.sources) redundancy += source.redundancy;
  EXPECT_NEAR(redundancy, 33.0, 1e-10);
  EXPECT_EQ(result.freedom, 33);
}

TEST(Problem, AHeldParameterKeepsItsValueAndIsNotEstimated) {
  const MatrixXd a = RandomMatrix(30, 3, 5);
  const VectorXd y = RandomMatrix(30, 1, 6);
  Problem problem;
  ParameterBlock block = Block("p", {"a", "b", "c"});
  block["b"].value = 0.7;
  block["b"].held = true;
  const BlockId p = problem.Add(block);
  problem.Add(problem.AddSource("s"), Linear(a, y), {p}, 1.0);
  const Result result = problem.Solve();
  MatrixXd rest(30, 2);
  rest << a.col(0), a.col(2);
  const VectorXd left = y - 0.7 * a.col(1);
  const VectorXd x = rest.colPivHouseholderQr().solve(left);
  EXPECT_NEAR(result.Value("p.a"), x[0], 1e-12);
  EXPECT_EQ(result.Value("p.b"), 0.7);
  EXPECT_EQ(result.Uncertainty("p.b"), 0.0);
  EXPECT_EQ(result.Seen("p.b"), SeenBy::kHeld);
  EXPECT_EQ(result.Covariance("p", "p")(1, 2), 0.0);
  EXPECT_EQ(result.names, (std::vector<std::string>{"p.a", "p.c"}));
}

TEST(Problem, WithAllHeldItJudgesHeldOutData) {
  Problem problem;
  ParameterBlock block = Block("p", {"a"});
  block["a"].value = 2.0;
  block.Hold();
  const BlockId p = problem.Add(block);
  problem.Add(problem.AddSource("s"), Linear(MatrixXd::Ones(2, 1), Eigen::Vector2d(1.0, 5.0)), {p},
              0.5);
  const Result result = problem.Solve();
  EXPECT_TRUE(result.Usable());
  EXPECT_DOUBLE_EQ(result.Source("s").chi_square, 4.0 + 36.0);
  EXPECT_DOUBLE_EQ(result.Source("s").redundancy, 2.0);
}

TEST(Problem, SpansOfABlockAreItsEntries) {
  // Two local lines over a chain of five coefficients, as splines use them.
  const VectorXd truth = RandomMatrix(5, 1, 9);
  Problem problem;
  const BlockId c = problem.Add(Block("c", {"0", "1", "2", "3", "4"}));
  const SourceId s = problem.AddSource("s");
  for (int first = 0; first < 4; ++first) {
    const MatrixXd a = RandomMatrix(4, 2, 20 + std::uint64_t(first));
    problem.Add(s, Linear(a, a * truth.segment(first, 2)), {Input(c, first, 2)}, 1e-3);
  }
  const Result result = problem.Solve();
  EXPECT_LT((result.Block("c").Values() - truth).norm(), 1e-12);
}

TEST(Problem, ASourceThatIsKnowledgeDoesNotCountAsData) {
  // Smoothness alone holds the second coefficient.
  Problem problem;
  const BlockId c = problem.Add(Block("c", {"0", "1"}));
  problem.Add(problem.AddSource("data"), Linear(MatrixXd::Ones(3, 1), VectorXd::Ones(3)),
              {Input(c, 0, 1)}, 0.01);
  problem.Add(problem.AddSource("smoothness", {.is_prior = true}),
              Linear(Eigen::RowVector2d(1.0, -1.0), VectorXd::Zero(1)), {c}, 0.5);
  const Result result = problem.Solve();
  ASSERT_TRUE(result.Usable());
  EXPECT_NEAR(result.Value("c.1"), 1.0, 1e-12);
  EXPECT_NEAR(result.Uncertainty("c.1"), std::hypot(0.5, 0.01 / std::sqrt(3.0)), 1e-12);
  EXPECT_EQ(result.Seen("c.0"), SeenBy::kData);
  EXPECT_EQ(result.Seen("c.1"), SeenBy::kPrior);
  ASSERT_EQ(result.weak_directions.size(), 1u);
  EXPECT_EQ(result.weak_directions[0].held, WeakDirection::Held::kByPrior);
}

struct Exponential {
  std::vector<double> t, y;
  template <class T>
  void operator()(const T* x, T* values) const {
    for (std::size_t i = 0; i < t.size(); ++i) values[i] = x[0] * exp(-x[1] * t[i]) + x[2] - y[i];
  }
};

TEST(Problem, AutoDiffJacobianAgreesWithDifferencesForAnyStride) {
  const Exponential model{{0.0, 0.5, 2.0}, {1.0, 2.0, 3.0}};
  const VectorXd x = Eigen::Vector3d(1.3, 0.7, -0.2);
  RowMatrix by_one(3, 3), by_four(3, 3);
  VectorXd values(3), high(3), low(3);
  MakeAutoDiffResidual<1>(model, 3)->Evaluate(x, values, &by_one);
  const auto residual = MakeAutoDiffResidual<4>(model, 3);
  residual->Evaluate(x, values, &by_four);
  EXPECT_EQ(by_one, by_four);
  for (int j = 0; j < 3; ++j) {
    constexpr double kStep = 1e-5;  // error kStep^2 and eps / kStep: 1e-10
    residual->Evaluate(x + kStep * VectorXd::Unit(3, j), high, nullptr);
    residual->Evaluate(x - kStep * VectorXd::Unit(3, j), low, nullptr);
    EXPECT_LT(((high - low) / (2 * kStep) - by_four.col(j)).norm(), 1e-9);
  }
}

TEST(Problem, RobustSourceBoundsAndNamesOutliers) {
  constexpr int kN = 400;
  VectorXd y = RandomMatrix(kN, 1, 31);
  for (int i = 0; i < 20; ++i) y[i] += 50.0 + i;
  const auto solve = [&](const RobustLoss& loss) {
    Problem problem;
    const BlockId p = problem.Add(Block("p", {"mean"}));
    problem.Add(problem.AddSource("s", {.loss = loss}), Linear(MatrixXd::Ones(kN, 1), y), {p}, 1.0);
    return problem.Solve();
  };
  const Result plain = solve(RobustLoss::None());
  const Result huber = solve(RobustLoss::Huber());
  const Result cauchy = solve(RobustLoss::Cauchy());
  const double good = y.tail(kN - 20).mean();
  EXPECT_NEAR(plain.Value("p.mean"), y.mean(), 1e-12);
  // Huber: 20 values each pull with k = 2 against 380 with Phi(2) - Phi(-2) slope.
  EXPECT_NEAR(huber.Value("p.mean") - good, 20 * 2.0 / (380 * 0.9545), 0.02);
  // Cauchy: the pull of t is about k^2 / t.
  EXPECT_NEAR(cauchy.Value("p.mean"), good, 20 * 2.385 * 2.385 / 50 / (380 * 0.5) + 0.03);
  for (const Result& result : {huber, cauchy}) {
    const SourceResult& source = result.Source("s");
    ASSERT_GE(source.outlier_count, 20);
    EXPECT_EQ(source.outliers[0].row, 19);
    EXPECT_NEAR(source.outliers[0].normalised, result.Value("p.mean") - y[19], 1e-9);
  }
}

TEST(Problem, ManyRowsInOneResidualAreManyRowsInMany) {
  const MatrixXd a = RandomMatrix(600, 4, 41);
  const VectorXd y = RandomMatrix(600, 1, 42);
  const auto solve = [&](Eigen::Index rows_each) {
    Problem problem;
    const BlockId p = problem.Add(Block("p", {"a", "b", "c", "d"}));
    const SourceId s = problem.AddSource("s", {.loss = RobustLoss::Huber(1.345)});
    for (Eigen::Index i = 0; i < 600; i += rows_each) {
      problem.Add(s, Linear(a.middleRows(i, rows_each), y.segment(i, rows_each)), {p}, 0.8);
    }
    return problem.Solve();
  };
  const Result one = solve(600), many = solve(1);
  EXPECT_LT((one.Block("p").Values() - many.Block("p").Values()).norm(), 1e-7);
  EXPECT_LT((one.covariance - many.covariance).norm(), 1e-7);
  EXPECT_EQ(one.Source("s").outlier_count, many.Source("s").outlier_count);
}

TEST(Problem, SaysWhichSourceIsNotFiniteAtTheStart) {
  Problem problem;
  const BlockId p = problem.Add(Block("arm", {"length", "angle"}));
  problem.Add(problem.AddSource("good"), Linear(MatrixXd::Identity(2, 2), VectorXd::Zero(2)), {p},
              1.0);
  const SourceId bad = problem.AddSource("encoder");
  problem.Add(bad, Linear(MatrixXd::Identity(2, 2), VectorXd::Zero(2)), {p}, 1.0);
  Problem values = problem, slopes = problem, thrown = problem;
  values.Add(bad,
             std::make_shared<Written>(2,
                                       [](const VectorXd&, VectorXd& v, RowMatrix* j) {
                                         v << 0.0, std::log(-1.0);
                                         if (j) j->setZero();
                                       }),
             {p}, 1.0);
  EXPECT_THAT(Words<NumericalError>([&] { values.Solve(); }),
              HasSubstr("source 'encoder', row 3: the residual is not finite"));
  slopes.Add(bad,
             std::make_shared<Written>(1,
                                       [](const VectorXd&, VectorXd& v, RowMatrix* j) {
                                         v.setZero();
                                         if (j) *j << 0.0, std::numeric_limits<double>::infinity();
                                       }),
             {p}, 1.0);
  EXPECT_THAT(Words<NumericalError>([&] { slopes.Solve(); }),
              HasSubstr("source 'encoder', row 2: the derivative by arm.angle is not finite"));
  thrown.Add(
      bad,
      std::make_shared<Written>(1, [](const VectorXd&, VectorXd&,
                                      RowMatrix*) { throw NumericalError("pose out of reach"); }),
      {p}, 1.0);
  EXPECT_THAT(Words<NumericalError>([&] { thrown.Solve(); }), HasSubstr("pose out of reach"));
}

TEST(Problem, StepsBackFromWhereTheModelEnds) {
  // log x = log 2 from x = 0.05: the first full Newton step leaves the domain from x = 10.
  Problem problem;
  ParameterBlock block = Block("p", {"x"});
  block["x"].value = 10.0;
  const BlockId p = problem.Add(block);
  problem.Add(problem.AddSource("s"),
              std::make_shared<Written>(1,
                                        [](const VectorXd& x, VectorXd& v, RowMatrix* j) {
                                          if (x[0] <= 0.0) throw NumericalError("x is not above 0");
                                          v[0] = std::log(x[0]) - std::log(2.0);
                                          if (j) (*j)(0, 0) = 1.0 / x[0];
                                        }),
              {p}, 1e-3);
  for (const std::size_t bytes : {std::size_t{200'000'000}, std::size_t{0}}) {
    EXPECT_NEAR(problem.Solve({.jacobian_bytes = bytes}).Value("p.x"), 2.0, 2e-9);
  }
}

TEST(Problem, OtherExceptionsOfAResidualPassThrough) {
  Problem problem;
  const BlockId p = problem.Add(Block("p", {"x"}));
  auto calls = std::make_shared<int>(0);
  problem.Add(problem.AddSource("s"),
              std::make_shared<Written>(1,
                                        [calls](const VectorXd& x, VectorXd& v, RowMatrix* j) {
                                          if (++*calls > 1) throw std::domain_error("broken");
                                          v[0] = x[0] - 1.0;
                                          if (j) (*j)(0, 0) = 1.0;
                                        }),
              {p}, 1.0);
  EXPECT_THROW(problem.Solve(), std::domain_error);
}

struct Stopped {};

// What was asked throws its own exception, and the next solve is as any other.
TEST(Problem, EndsBetweenItsStepsWhenTheProcessAsks) {
  Problem problem;
  const BlockId block = problem.Add(Block("x", {"a", "b"}));
  problem.Add(problem.AddSource("rows"), Linear(RandomMatrix(9, 2, 1), RandomMatrix(9, 1, 2)),
              {block}, 1.0);
  AskBetweenSteps([] { throw Stopped{}; });
  EXPECT_THROW(problem.Solve(), Stopped);
  AskBetweenSteps(nullptr);
  EXPECT_NO_THROW(problem.Solve());
}

// exp(-x) -> 0 has its minimum at infinity: each step is 1 long.
Problem Runaway(double standard_deviation) {
  Problem problem;
  const BlockId p = problem.Add(Block("p", {"x"}));
  problem.Add(problem.AddSource("runaway"),
              std::make_shared<Written>(1,
                                        [](const VectorXd& x, VectorXd& v, RowMatrix* j) {
                                          v[0] = std::exp(-x[0]);
                                          if (j) (*j)(0, 0) = -std::exp(-x[0]);
                                        }),
              {p}, standard_deviation);
  return problem;
}

TEST(Problem, SaysWhatDoesNotSettle) {
  const Problem problem = Runaway(1e-12);
  const std::string words = Words<NumericalError>([&] { problem.Solve({.max_iterations = 5}); });
  EXPECT_THAT(words, HasSubstr("did not converge in 5 passes"));
  EXPECT_THAT(words, HasSubstr("parameter p.x moves most, source 'runaway' pulls most"));
  EXPECT_THAT(words, HasSubstr("the rows of 'runaway' scatter at least"));
}

TEST(Problem, EndsAllItsPassesWhereNearIsGoodEnough) {
  const Problem problem = Runaway(1.0);
  SolveOptions options{.max_iterations = 5, .jacobian_bytes = 0};
  options.tolerated = 0.5 * std::exp(-5.0);
  EXPECT_THROW(problem.Solve(options), NumericalError);
  options.tolerated = 2.0 * std::exp(-5.0);
  EXPECT_NEAR(problem.Solve(options).Block("p")["x"].value, 5.0, 1e-9);
}

TEST(Problem, ResultStartsAsNotRun) {
  const Result result;
  EXPECT_FALSE(result.Usable());
  EXPECT_THAT(result.WhyNotUsable(), HasSubstr("not run"));
  EXPECT_THAT(result.Report(), HasSubstr("not run"));
}

TEST(Problem, RefusesAWrongSetup) {
  Problem problem;
  const BlockId p = problem.Add(Block("p", {"x", "y"}));
  const SourceId s = problem.AddSource("s");
  const auto line = Linear(MatrixXd::Ones(2, 2), VectorXd::Ones(2));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(Block("p", {"z"})); }), HasSubstr("already"));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(Block("q", {"z", "z"})); }), HasSubstr("twice"));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(Block("q", {"z"}, 0.0)); }), HasSubstr("q.z"));
  EXPECT_THAT(Words<InputError>([&] { problem.AddSource("prior"); }), HasSubstr("'prior'"));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(s, line, {p}, 0.0); }), HasSubstr("above 0"));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(s, line, {p}, VectorXd::Ones(3)); }),
              HasSubstr("2 rows with 3"));
  EXPECT_THAT(Words<InputError>([&] { problem.Add(s, line, {Input(p, 1, 2)}, 1.0); }),
              HasSubstr("block 'p', which has 2"));
  EXPECT_THAT(Words<InputError>([&] {
                problem.Add(s, line, {p, Input(p, 1, 1)}, 1.0);
              }),
              HasSubstr("twice"));
  EXPECT_THAT(Words<InputError>([&] { problem.Block(p)["z"]; }), HasSubstr("it has x, y"));
}

}  // namespace problem_test
}  // namespace abbe::estimation
