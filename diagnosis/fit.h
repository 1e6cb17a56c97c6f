// The simulation fitted to all runs of a campaign, with causes taken in, and made linear there.
//
//   const Fit fit(campaign);
//   const Fit better(fit, {candidate});
//   better.log_likelihood() - fit.log_likelihood();
//
// At the fit the runs are linear in everything: r(x + dx, c) = r + J dx - C c with the coefficients
// c of disturbances. The parameters of the simulation are nuisance parameters with the information
// H, their priors included; they are marginalised once for all disturbances, which leaves
//
//   S = C'C - C'J H^-1 J'C,    g = C'r - C'J H^-1 J'r        information and score of c
//
// Shapes: S n x n, g n x 1, n the coefficients of a group.
// Source: Rasmussen and Williams, Gaussian Processes (2006), 2.7.
// Units: SI.
// Validity: to first order at the fit.
// Failure: NumericalError when the fit does not settle.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/candidate.h"
#include "diagnosis/extended_run.h"
#include "estimation/problem.h"
#include "fusion/population_evidence.h"

namespace abbe::diagnosis {

struct FitSums;

class Fit {
 public:
  // The simulation as it is. NumericalError when the fit does not settle.
  explicit Fit(const Campaign& campaign);
  // With causes, started from an earlier fit of the same runs; made linear anew at most so often.
  Fit(const Fit& before, std::vector<Candidate> taken_in, int rounds = kMostRounds);

  const Campaign& campaign() const { return campaign_; }
  const estimation::Result& result() const { return result_; }
  const std::vector<Candidate>& taken_in() const { return taken_in_; }
  double chi_square() const;  // of the runs, by their stated noise
  // The same of the runs of arms, of rows that took no part: each of 16 blocks of poses is
  // held against the fit to all others, to first order.
  double left_out() const { return left_out_; }
  // Logarithm of the marginal likelihood of the data, by Laplace's approximation at the fit; all
  // fits to one campaign lack the same constant.
  double log_likelihood() const { return log_likelihood_; }
  // The errors of the machine without their prior; all else is marginalised.
  fusion::Quadratic OfMachine() const;
  Eigen::Index rows() const;
  // Coefficients of a cause that was taken in, and their covariance.
  Score ScoreOf(std::size_t taken_in) const;

  static constexpr int kMostRounds = 4;

  // What disturbances do to all runs, free of everything that the simulation could do instead.
  struct Projection {
    Eigen::MatrixXd information;  // S; 0 where nothing but rounding is left of a column
    Eigen::VectorXd score;        // g
  };
  // The columns of each run with a trace, one row each; the same stages for all.
  using Disturber =
      std::function<std::vector<simulation::Disturbance>(const simulation::Trace& trace)>;
  // The columns come in groups of so many; a projection for each.
  std::vector<Projection> Project(const Disturber& disturber,
                                  const std::vector<Eigen::Index>& groups) const;
  // For columns in one stage alone, one row of `functions` each over the rows of each run (empty:
  // the run takes no part).
  std::vector<Projection> ProjectInStage(Eigen::Index stage,
                                         const std::vector<Eigen::MatrixXd>& functions,
                                         const std::vector<Eigen::Index>& groups) const;
  // For many functions f of the rows of one stage in one run: their score is scores * f', and their
  // information weights * f^2' where the noise of the rows is independent, all unknowns known. Empty
  // where the run does not tell.
  struct RowScores {
    Eigen::RowVectorXd scores, weights;
  };
  // `run`: index into the campaign.
  RowScores ScoresOf(std::size_t run, Eigen::Index stage) const;
  // With the readings as they would be without noise.
  const simulation::Trace& TraceOf(std::size_t run) const { return runs_[run].at.trace; }
  // What is left of a run, whitened.
  const Eigen::VectorXd& LeftOf(std::size_t run) const { return runs_[run].r; }
  std::size_t runs() const { return runs_.size(); }
  // For a cause with columns that was taken in, beside all others.
  Projection ProjectionOf(std::size_t taken_in) const;
  // For a cause that relaxes parameters.
  Projection ProjectParameters(const Candidate& candidate) const;
  // How the coefficients of each cause that was taken in, and its free shape, move when those of the
  // disturbances become one: H^-1 J'C, a column each; empty for one without columns.
  std::vector<Eigen::MatrixXd> MovedBy(const Disturber& disturber,
                                       const std::vector<Eigen::Index>& groups) const;

 private:
  struct RunRows {
    LinearRun at;
    Eigen::VectorXd r;
    std::vector<int> columns;
    Eigen::MatrixXd back;  // [J r], back to the readings
  };

  // The runs at the fit, with all that is needed to start another one from them.
  void TakeRuns(const estimation::Problem& problem);
  // The same, and what all data say together.
  void Linearize(const estimation::Problem& problem, FitSums at);
  double FollowShapes();
  // What a random field's draws tell of their deviation.
  struct Draws {
    double seen = 0.0, squares = 0.0;  // how many the data determine, at least one; of the found
  };
  Draws DrawsOf(const Candidate& cause) const;
  double LeftOut(const Eigen::VectorXd& r, const std::vector<int>& columns,
                 const Eigen::MatrixXd& J) const;
  // [C'J C'r] of one run.
  Eigen::MatrixXd Against(const RunRows& run,
                          const std::vector<simulation::Disturbance>& disturbances) const;
  // Whitened, a column for each function.
  static Eigen::MatrixXd InStage(const RunRows& run, Eigen::Index stage,
                                 const Eigen::MatrixXd& functions);
  // C'C of each group of columns, C'J and C'r of all.
  struct Products {
    std::vector<Eigen::MatrixXd> C_C;
    Eigen::MatrixXd C_J;
    Eigen::VectorXd C_r;
  };
  Products ProductsOf(const Disturber& disturber, const std::vector<Eigen::Index>& groups) const;
  std::vector<Projection> Finish(const Products& products) const;
  std::vector<int> ColumnsNamed(const std::string& pattern) const;

  const Campaign& campaign_;
  std::vector<Candidate> taken_in_;
  estimation::Result result_;
  std::vector<std::string> names_;
  std::vector<RunRows> runs_;
  Eigen::MatrixXd data_information_;
  Eigen::VectorXd data_gradient_, gradient_, prior_;
  double log_likelihood_ = 0.0, left_out_ = 0.0;
  Eigen::VectorXd scale_;  // H = scale^-1 (scaled) scale^-1
  Eigen::LLT<Eigen::MatrixXd> H_;
};

}  // namespace abbe::diagnosis
