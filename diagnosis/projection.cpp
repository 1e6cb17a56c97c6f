// What Fit knows of disturbances: their information and score, free of all unknowns.
#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "diagnosis/fit.h"
#include "failure/interruption.h"
#include "fusion/machine_problem.h"

namespace abbe::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Disturbance;

namespace {

// C'C within each group, of those columns `which` of all that act.
void AddBlocks(const MatrixXd& C, const std::vector<Index>& which,
               const std::vector<std::size_t>& group_of, std::vector<MatrixXd>& C_C) {
  for (Index first = 0; first < C.cols();) {
    const std::size_t group = group_of[which[first]];
    const auto begin = std::find(group_of.begin(), group_of.end(), group) - group_of.begin();
    std::vector<Index> own;
    Index last = first;
    for (; last < C.cols(); ++last) {
      const Index column = which[last];
      if (group_of[column] != group) break;
      own.push_back(column - begin);
    }
    const auto acting = C.middleCols(first, last - first);
    C_C[group](own, own) += acting.transpose() * acting;
    first = last;
  }
}

// Functions of the rows of a run without those that say nothing new: what goes by a variable that
// stands still in the run is a constant, and all constants are one function.
class DistinctFunctions {
 public:
  struct Group {
    Index first;              // of the functions given
    std::vector<Index> rows;  // of functions(); none: zero in this run
    VectorXd factors;         // of these
  };

  // `functions`: a row for each, in groups of so many.
  DistinctFunctions(const MatrixXd& functions, const std::vector<Index>& groups) {
    std::vector<Index> varying;
    for (Index first = 0; const Index count : groups) {
      Group group{first, {}, VectorXd::Ones(count)};
      const auto own = functions.middleRows(first, count);
      if (Varies(own)) {
        for (Index i = 0; i < count; ++i) {
          group.rows.push_back(std::ssize(varying));
          varying.push_back(first + i);
        }
      } else if (!own.col(0).isZero(0.0)) {
        group.rows.assign(static_cast<std::size_t>(count), kConstant);
        group.factors = own.col(0);
      }
      groups_.push_back(std::move(group));
      first += count;
    }
    const Index count = std::ssize(varying);
    bool has_constants = false;
    for (Group& group : groups_) {
      for (Index& row : group.rows) {
        if (row != kConstant) continue;
        row = count;
        has_constants = true;
      }
    }
    functions_.resize(count + (has_constants ? 1 : 0), functions.cols());
    functions_.topRows(count) = functions(varying, Eigen::all);
    if (has_constants) functions_.bottomRows<1>().setOnes();
  }

  const MatrixXd& functions() const { return functions_; }
  const std::vector<Group>& groups() const { return groups_; }

 private:
  static constexpr Index kConstant = -1;

  static bool Varies(const Eigen::Ref<const MatrixXd>& functions) {
    for (Index i = 1; i < functions.cols(); ++i) {
      if (functions.col(i) != functions.col(0)) return true;
    }
    return false;
  }

  std::vector<Group> groups_;
  MatrixXd functions_;
};

}  // namespace

std::vector<Fit::Projection> Fit::Finish(const Products& products) const {
  MayBeInterrupted();
  const auto& [C_C, C_J, C_r] = products;
  constexpr double kRounding = 1e-9;  // of the information of a column
  std::vector<Index> acting;          // of all columns
  Index first = 0;
  for (const MatrixXd& own : C_C) {
    for (Index c = 0; c < own.cols(); ++c) {
      if (own(c, c) > 0.0) acting.push_back(first + c);
    }
    first += own.cols();
  }
  // B = L^-1 J'C, with H = L L'.
  MatrixXd B = scale_.asDiagonal() * C_J(acting, Eigen::all).transpose();
  H_.matrixL().solveInPlace(B);
  const VectorXd slope = H_.matrixL().solve(scale_.cwiseProduct(gradient_));
  const VectorXd score = C_r(acting) - B.transpose() * slope;
  std::vector<Projection> groups;
  groups.reserve(C_C.size());
  first = 0;
  for (Index begin = 0, end = 0; const MatrixXd& own : C_C) {
    const Index count = own.cols();
    Projection left{MatrixXd::Zero(count, count), VectorXd::Zero(count)};
    for (begin = end; end < B.cols() && acting[end] < first + count;) {
      ++end;
    }
    const auto group = B.middleCols(begin, end - begin);
    const MatrixXd taken = group.transpose() * group;
    for (Index i = begin; i < end; ++i) {
      const Index c = acting[i] - first;
      for (Index j = begin; j < end; ++j) {
        const Index d = acting[j] - first;
        left.information(c, d) = own(c, d) - taken(i - begin, j - begin);
      }
      left.score[c] = score[i];
    }
    for (Index c = 0; c < count; ++c) {
      if (left.information(c, c) > kRounding * own(c, c)) continue;
      left.information.row(c).setZero();
      left.information.col(c).setZero();
      left.score[c] = 0.0;
    }
    groups.push_back(std::move(left));
    first += count;
  }
  return groups;
}

fusion::Quadratic Fit::OfMachine() const {
  const std::vector<int> columns = fusion::ColumnsOf(names_, campaign_.model().Blocks());
  VectorXd of_others = prior_, x = VectorXd::Zero(prior_.size());
  VectorXd gradient = gradient_;
  of_others(columns).setZero();
  gradient(columns) = data_gradient_(columns);
  x(columns) = fusion::ValuesFound(result_, campaign_.model().Blocks());
  fusion::Quadratic all{data_information_, -gradient};
  all.information.diagonal() += of_others;
  all.vector += all.information * x;
  return fusion::Marginalised(all, columns);
}

Fit::RowScores Fit::ScoresOf(std::size_t run, Index stage) const {
  const RunRows& rows = runs_[run];
  if (!rows.at.response) return {};
  return {rows.at.response->BackToStage(stage, rows.back.rightCols<1>()).transpose(),
          rows.at.response->WeightsOf(stage)};
}

MatrixXd Fit::Against(const RunRows& run, const std::vector<Disturbance>& disturbances) const {
  std::map<Index, std::vector<Index>> acting;
  for (std::size_t d = 0; d < disturbances.size(); ++d) {
    for (const auto& [stage, values] : disturbances[d].stages()) {
      acting[stage].push_back(d);
    }
  }
  MatrixXd against = MatrixXd::Zero(disturbances.size(), run.back.cols());
  for (const auto& [stage, who] : acting) {
    const MatrixXd of_stage = run.at.response->BackToStage(stage, run.back);
    MatrixXd values(who.size(), of_stage.rows());
    for (Index i = 0; i < values.rows(); ++i) {
      values.row(i) = disturbances[who[i]].stages().at(stage);
    }
    against(who, Eigen::all) += values * of_stage;
  }
  return against;
}

Fit::Products Fit::ProductsOf(const Disturber& disturber, const std::vector<Index>& groups) const {
  const Index columns = std::accumulate(groups.begin(), groups.end(), Index{0});
  Products products{{}, MatrixXd::Zero(columns, std::ssize(names_)), VectorXd::Zero(columns)};
  auto& [C_C, C_J, C_r] = products;
  C_C.reserve(groups.size());
  std::vector<std::size_t> group_of;
  for (const Index count : groups) {
    group_of.insert(group_of.end(), count, C_C.size());
    C_C.push_back(MatrixXd::Zero(count, count));
  }
  for (const RunRows& run : runs_) {
    if (!run.at.response) continue;
    std::vector<Disturbance> acting = disturber(run.at.trace);
    std::vector<Index> which;
    for (std::size_t c = 0; c < acting.size(); ++c) {
      if (!acting[c].stages().empty()) which.push_back(c);
    }
    if (which.empty()) continue;
    std::erase_if(acting, [](const Disturbance& each) { return each.stages().empty(); });
    AddBlocks(run.at.response->Columns(acting), which, group_of, C_C);
    const MatrixXd against = Against(run, acting);
    C_J(which, run.columns) += against.leftCols(against.cols() - 1);
    C_r(which) += against.rightCols<1>();
  }
  return products;
}

std::vector<Fit::Projection> Fit::Project(const Disturber& disturber,
                                          const std::vector<Index>& groups) const {
  return Finish(ProductsOf(disturber, groups));
}

std::vector<MatrixXd> Fit::MovedBy(const Disturber& disturber,
                                   const std::vector<Index>& groups) const {
  const MatrixXd J_C = ProductsOf(disturber, groups).C_J.transpose();
  const MatrixXd all = scale_.asDiagonal() * H_.solve(scale_.asDiagonal() * J_C);
  std::vector<MatrixXd> moved;
  for (const Candidate& cause : taken_in_) {
    moved.emplace_back();
    if (!cause.HasColumns()) continue;
    moved.back() = all(fusion::ColumnsOf(names_, {result_.Block(BlockOf(cause))}), Eigen::all);
  }
  return moved;
}

std::vector<Fit::Projection> Fit::ProjectInStage(Index stage,
                                                 const std::vector<MatrixXd>& functions,
                                                 const std::vector<Index>& groups) const {
  const Index columns = std::accumulate(groups.begin(), groups.end(), Index{0});
  std::vector<MatrixXd> C_C;
  C_C.reserve(groups.size());
  for (const Index count : groups) C_C.push_back(MatrixXd::Zero(count, count));
  MatrixXd C_J = MatrixXd::Zero(columns, static_cast<Index>(names_.size()));
  VectorXd C_r = VectorXd::Zero(columns);
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const RunRows& run = runs_[r];
    if (!run.at.response || functions[r].size() == 0) continue;
    const simulation::Response& response = *run.at.response;
    const Eigen::RowVectorXd weights = response.WeightsOf(stage);
    if (weights.size() == 0 || !(weights.maxCoeff() > 0.0)) continue;
    const DistinctFunctions distinct(functions[r], groups);
    const MatrixXd& own = distinct.functions();
    if (own.rows() == 0) continue;
    const MatrixXd against = own * response.BackToStage(stage, run.back);
    const MatrixXd whitened = response.RowsAreIndependent()
                                  ? MatrixXd(own * weights.cwiseSqrt().asDiagonal())
                                  : MatrixXd(InStage(run, stage, own).transpose());
    for (std::size_t group = 0; group < groups.size(); ++group) {
      const auto& [first, rows, factors] = distinct.groups()[group];
      if (rows.empty()) continue;
      const MatrixXd part = factors.asDiagonal() * whitened(rows, Eigen::all);
      C_C[group].noalias() += part * part.transpose();
      const MatrixXd slopes = factors.asDiagonal() * against(rows, Eigen::all);
      C_J(Eigen::seqN(first, groups[group]), run.columns) += slopes.leftCols(slopes.cols() - 1);
      C_r.segment(first, groups[group]) += slopes.rightCols<1>();
    }
  }
  return Finish({std::move(C_C), C_J, C_r});
}

MatrixXd Fit::InStage(const RunRows& run, Index stage, const MatrixXd& functions) {
  std::vector<Disturbance> disturbances;
  disturbances.reserve(static_cast<std::size_t>(functions.rows()));
  for (const auto& function : functions.rowwise()) {
    disturbances.push_back(simulation::InStage(run.at.trace, stage, function));
  }
  return run.at.response->Columns(disturbances);
}

std::vector<int> Fit::ColumnsNamed(const std::string& pattern) const {
  std::vector<int> columns;
  for (std::size_t c = 0; c < names_.size(); ++c) {
    if (Matches(names_[c], pattern)) columns.push_back(static_cast<int>(c));
  }
  return columns;
}

Fit::Projection Fit::ProjectionOf(std::size_t taken_in) const {
  const Candidate& cause = taken_in_[taken_in];
  const Index count = cause.cause->coefficients();
  const MatrixXd covariance =
      result_.Covariance(BlockOf(cause), BlockOf(cause)).topLeftCorner(count, count);
  const MatrixXd one = MatrixXd::Identity(count, count);
  const MatrixXd known = covariance.ldlt().solve(one);
  Projection beside{known, known * result_.Block(BlockOf(cause)).Values().head(count)};
  beside.information.diagonal() -= cause.Plausible().cwiseAbs2().cwiseInverse();
  return beside;
}

Fit::Projection Fit::ProjectParameters(const Candidate& candidate) const {
  const std::vector<std::string> patterns = candidate.cause->relaxes(candidate.object);
  const Index count = patterns.size();
  MatrixXd select = MatrixXd::Zero(count, names_.size());
  for (Index i = 0; i < count; ++i) {
    for (const int column : ColumnsNamed(patterns[i])) {
      select(i, column) = -1.0;
    }
  }
  const MatrixXd C_J = select * data_information_;
  return Finish({{C_J * select.transpose()}, C_J, select * data_gradient_}).front();
}

}  // namespace abbe::diagnosis
