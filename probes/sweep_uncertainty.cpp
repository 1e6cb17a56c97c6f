#include "probes/sweep_uncertainty.h"

#include <cmath>
#include <functional>
#include <utility>

#include "probes/probe_linearity.h"

namespace abbe::probes {
namespace {

// Where the measuring line of a probe meets the face at the start: along u, and across it.
Eigen::Vector2d PlaceOf(const HeadLayout<>& layout, std::size_t probe) {
  if (probe < kTopProbes) return {layout.top[probe].u, layout.top[probe].s};
  return {layout.side[probe - kTopProbes].u, layout.side[probe - kTopProbes].n};
}

bool OnTop(std::size_t probe) { return probe < kTopProbes; }

}  // namespace

double UncheckedTimes(double known_to) { return std::exp(std::pow(std::log(known_to), 2)); }

SweepUncertainty::SweepUncertainty(const machine::Machine& machine, const HeadSettings& head,
                                   const TargetSettings& target, char axis,
                                   const Eigen::Vector3d& start, const StationMeans& means)
    : head_(head), target_(target), means_(means), first_(std::ssize(means.directions)) {
  const SweepInversion nominal(machine, head, axis, start);
  moving_ = nominal.moving();
  travel_ = means.position.unaryExpr([&](double position) { return nominal.Travel(position); });
  jacobians_ = nominal.Jacobians(means.gap, means.position, first_);
  AddForm();

  const auto errors = [&](const HeadSettings& changed) {
    return SweepInversion(machine, changed, axis, start).Errors(means.gap, means.position, first_);
  };
  // `parameter` selects the value to vary, in a copy of the head.
  const auto add = [&](Columns& columns, double sd,
                       const std::function<double&(HeadSettings&)>& parameter) {
    if (sd == 0.0) return;
    HeadSettings up = head, down = head;
    parameter(up) += sd;
    parameter(down) -= sd;
    columns.push_back((errors(up) - errors(down)) / 2.0);
  };
  const HeadTolerance& tolerance = head.tolerance;
  for (std::size_t i = 0; i < kProbes; ++i) {
    add(gain_, tolerance.gain, [i](HeadSettings& h) -> double& { return h.probes[i].gain; });
  }
  const double place = tolerance.probe_position;
  for (std::size_t i = 0; i < kTopProbes; ++i) {
    add(position_, place, [i](HeadSettings& h) -> double& { return h.layout.top[i].u; });
    add(position_, place, [i](HeadSettings& h) -> double& { return h.layout.top[i].s; });
  }
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    add(position_, place, [i](HeadSettings& h) -> double& { return h.layout.side[i].u; });
    add(position_, place, [i](HeadSettings& h) -> double& { return h.layout.side[i].n; });
  }
  using Turn = double Installation<>::*;
  for (const Turn angle : {&Installation<>::roll, &Installation<>::pitch, &Installation<>::yaw}) {
    add(installation_, tolerance.installation,
        [angle](HeadSettings& h) -> double& { return h.installation.*angle; });
  }
  for (const Turn offset : {&Installation<>::du, &Installation<>::ds, &Installation<>::dn}) {
    add(installation_, tolerance.offset,
        [offset](HeadSettings& h) -> double& { return h.installation.*offset; });
  }
}

Eigen::VectorXd SweepUncertainty::Sensitivity(Eigen::Index row, std::size_t probe) const {
  Eigen::VectorXd values(jacobians_.size());
  for (Eigen::Index group = 0; group < values.size(); ++group) {
    values[group] = jacobians_[group](row, probe);
  }
  return values;
}

void SweepUncertainty::TakeZero(std::size_t row_probe, std::size_t column_probe,
                                Eigen::MatrixXd& V) const {
  if (!head_.probes[row_probe].zero_gap) {
    const Eigen::RowVectorXd mean = V.topRows(first_).colwise().mean();
    V.rowwise() -= mean;
  }
  if (!head_.probes[column_probe].zero_gap) {
    const Eigen::VectorXd mean = V.leftCols(first_).rowwise().mean();
    V.colwise() -= mean;
  }
}

PerProbe<Eigen::MatrixXd> SweepUncertainty::Departures(const PerProbe<>& linearity) const {
  PerProbe<Eigen::MatrixXd> of_gaps;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    of_gaps[probe] = LinearityCovariance(means_.gap.row(static_cast<Eigen::Index>(probe)),
                                         linearity[probe], head_.probes[probe].range);
  }
  return of_gaps;
}

Eigen::MatrixXd SweepUncertainty::UsualLinearity(Eigen::Index row) const {
  PerProbe<> usual = head_.Ranges();
  for (double& each : usual) each *= kUsualLinearity;
  return ProbeCovariance(row, Departures(usual));
}

Eigen::MatrixXd SweepUncertainty::ProbeCovariance(Eigen::Index row,
                                                  PerProbe<Eigen::MatrixXd> of_gaps) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(means_.groups(), means_.groups());
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    Eigen::MatrixXd& V = of_gaps[probe];
    TakeZero(probe, probe, V);
    const Eigen::VectorXd by_gap = Sensitivity(row, probe) / head_.probes[probe].gain;
    sum += by_gap.asDiagonal() * V * by_gap.asDiagonal();
  }
  return sum;
}

void SweepUncertainty::AddForm() {
  const Eigen::Index groups = means_.groups();
  const double sense = moving_ == MovingBody::kTarget ? -1.0 : 1.0;
  const double variance = std::pow(target_.form * UncheckedTimes(target_.form_known_to), 2);
  const double scale = -0.5 / (target_.form_length * target_.form_length);
  for (std::size_t p = 0; p < kProbes; ++p) {
    for (std::size_t q = 0; q < kProbes; ++q) {
      if (OnTop(p) != OnTop(q)) continue;
      const Eigen::Vector2d apart = PlaceOf(head_.layout, p) - PlaceOf(head_.layout, q);
      Eigen::MatrixXd V(groups, groups);
      for (Eigen::Index h = 0; h < groups; ++h) {
        for (Eigen::Index g = 0; g < groups; ++g) {
          const double along = apart[0] + sense * (travel_[g] - travel_[h]);
          V(g, h) = variance * std::exp(scale * (along * along + apart[1] * apart[1]));
        }
      }
      TakeZero(p, q, V);
      form_.push_back({p, q, std::move(V)});
    }
  }
}

Eigen::MatrixXd SweepUncertainty::FormCovariance(Eigen::Index row) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(means_.groups(), means_.groups());
  for (const auto& [p, q, V] : form_) {
    sum += Sensitivity(row, p).asDiagonal() * V * Sensitivity(row, q).asDiagonal();
  }
  return sum;
}

Eigen::MatrixXd SweepUncertainty::ColumnCovariance(const Columns& columns, Eigen::Index row) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(means_.groups(), means_.groups());
  for (const GroupErrors& column : columns) {
    sum += column.row(row).transpose() * column.row(row);
  }
  return sum;
}

std::array<Eigen::MatrixXd, kSources> SweepUncertainty::Covariance(Eigen::Index row) const {
  PerProbe<> linearity{};
  linearity.fill(head_.tolerance.linearity);
  return {ProbeCovariance(row, means_.covariance),     ColumnCovariance(gain_, row),
          ProbeCovariance(row, Departures(linearity)), ColumnCovariance(position_, row),
          ColumnCovariance(installation_, row),        FormCovariance(row)};
}

}  // namespace abbe::probes
