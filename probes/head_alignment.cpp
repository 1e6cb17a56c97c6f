#include "probes/head_alignment.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::probes {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSeen = 0.8;       // of the travel
constexpr double kApart = 1e-3;     // m, between two places
constexpr Eigen::Index kLines = 7;  // unknowns: a gap for each probe, a slope for each face
constexpr Eigen::Index kTopSlope = 5, kSideSlope = 6;

constexpr Eigen::Index SlopeOf(std::size_t probe) {
  return probe < kTopProbes ? kTopSlope : kSideSlope;
}

// The places of the last setting where all probes have a gap.
std::vector<GapsAt> LastSetting(std::span<const GapsAt> readings) {
  std::vector<GapsAt> last;
  for (const GapsAt& at : readings) {
    if (at.setting != readings.back().setting) continue;
    if (std::ranges::none_of(at.gap, [](double gap) { return std::isnan(gap); })) {
      last.push_back(at);
    }
  }
  return last;
}

}  // namespace

std::vector<ScrewTurn> HalfBack(std::span<const ScrewTurn> turns) {
  std::vector<ScrewTurn> back;
  for (const ScrewTurn& turn : turns) {
    const double half = kFinestTurn * std::round(-0.5 * turn.turns / kFinestTurn);
    if (half != 0.0) back.push_back({turn.screw, half});
  }
  return back;
}

HeadAligner::HeadAligner(const machine::Machine& machine, const HeadSettings& head,
                         const AlignSettings& settings, char axis, double first, double last)
    : settings_(settings),
      ranges_(head.Ranges()),
      sense_(machine.chain.CarriageSense(axis)),
      first_(first),
      end_(sense_ * (last - first)),
      motion_(head.layout,
              machine.chain.CarriesTarget(axis) ? MovingBody::kTarget : MovingBody::kHead,
              head.Frame(axis).R_MH, settings.screws) {}

VectorXd HeadAligner::ScrewedBy(std::span<const ScrewTurn> turns) const {
  VectorXd moved = VectorXd::Zero(static_cast<Eigen::Index>(settings_.screws.size()));
  for (const ScrewTurn& turn : turns) {
    moved[static_cast<Eigen::Index>(turn.screw)] = turn.turns * settings_.screws[turn.screw].pitch;
  }
  return moved;
}

bool HeadAligner::Fits(const PerProbe<GapOutlook>& outlook) const {
  return std::ranges::all_of(
      outlook, [&](const GapOutlook& probe) { return probe.Room() >= settings_.margin; });
}

HeadAlignment HeadAligner::Evaluate(std::span<const GapsAt> readings) const {
  const std::vector<GapsAt> places =
      readings.empty() ? std::vector<GapsAt>{} : LastSetting(readings);
  const auto [low, high] = places.empty() ? std::pair{0.0, 0.0} : [&] {
    const auto ends = std::ranges::minmax(places, {}, &GapsAt::travel);
    return std::pair{ends.min.travel, ends.max.travel};
  }();
  if (high - low < kApart) {
    throw InputError(fmt::format(
        "the gaps are known at one place of the travel only; read them at a second one, {:.3g} mm "
        "away or more",
        kApart / settings::kMillimetre));
  }
  const auto rows = static_cast<Eigen::Index>(kProbes * places.size());
  MatrixXd lines = MatrixXd::Zero(rows, kLines);
  VectorXd gaps(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto probe = static_cast<std::size_t>(row) % kProbes;
    const GapsAt& at = places[static_cast<std::size_t>(row) / kProbes];
    lines(row, static_cast<Eigen::Index>(probe)) = 1.0;
    lines(row, SlopeOf(probe)) = at.travel;
    gaps[row] = at.gap[probe];
  }
  const auto solver = lines.colPivHouseholderQr();
  const VectorXd line = solver.solve(gaps);
  const double scatter =
      std::max(settings_.motion,
               (lines * line - gaps).norm() /
                   std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, rows - kLines))));
  const MatrixXd covariance = scatter * scatter * (lines.transpose() * lines).inverse();

  HeadAlignment found;
  found.seen = (high - low) / std::abs(end_);
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto own = static_cast<Eigen::Index>(probe);
    const auto uncertainty = [&](double travel) {
      VectorXd at = VectorXd::Zero(kLines);
      at[own] = 1.0;
      at[SlopeOf(probe)] = travel;
      return std::sqrt(at.dot(covariance * at));
    };
    found.now[probe] = {line[own], line[own] + line[SlopeOf(probe)] * end_,
                        std::max(uncertainty(0.0), uncertainty(end_)), ranges_[probe]};
  }
  // The gap shrinks where the face rises.
  const double way = motion_.way();
  found.top = {-way * line[kTopSlope], std::sqrt(covariance(kTopSlope, kTopSlope))};
  found.side = {-way * line[kSideSlope], std::sqrt(covariance(kSideSlope, kSideSlope))};
  Propose(found);
  return found;
}

void HeadAligner::Propose(HeadAlignment& found) const {
  const bool by_hand = settings_.screws.empty();
  const auto screws = static_cast<Eigen::Index>(settings_.screws.size());
  const auto response_at = [&](double travel) -> MatrixXd {
    return by_hand ? MatrixXd(motion_.OfTarget(travel)) : MatrixXd(motion_.At(travel));
  };
  const std::array<MatrixXd, 2> response = {response_at(0.0), response_at(end_)};
  MatrixXd all(2 * kProbes, response[0].cols());
  VectorXd off(2 * kProbes);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kProbes); ++i) {
    const GapOutlook& probe = found.now[static_cast<std::size_t>(i)];
    for (Eigen::Index end = 0; end < 2; ++end) {
      const Eigen::Index row = 2 * i + end;
      all.row(row) = response[static_cast<std::size_t>(end)].row(i) / probe.range;
      off[row] = ((end == 0 ? probe.first : probe.last) - 0.5 * probe.range) / probe.range;
    }
  }
  VectorXd unit = VectorXd::Ones(all.cols());
  for (Eigen::Index k = 0; k < screws; ++k) {
    if (settings_.screws[static_cast<std::size_t>(k)].pitch == 0.0) unit[k] = 0.0;
  }
  if (by_hand) unit.tail<3>().setConstant(1.0 / std::max(std::abs(end_), kApart));
  auto solver = Eigen::CompleteOrthogonalDecomposition<MatrixXd>();
  solver.setThreshold(1e-6);
  solver.compute(all * unit.asDiagonal());
  VectorXd moved = unit.asDiagonal() * solver.solve(VectorXd(-off));
  if (by_hand) {
    found.motion = moved;
  } else {
    for (std::size_t k = 0; k < settings_.screws.size(); ++k) {
      const double pitch = settings_.screws[k].pitch;
      if (pitch == 0.0) continue;
      const double turns =
          kFinestTurn * std::round(moved[static_cast<Eigen::Index>(k)] / pitch / kFinestTurn);
      if (turns != 0.0) found.turns.push_back({k, turns});
    }
    moved = ScrewedBy(found.turns);
    found.motion = motion_.MotionOf(ScrewedBody::kTarget) * moved;
  }
  found.after = found.now;
  for (std::size_t i = 0; i < kProbes; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    found.after[i].first += response[0].row(row).dot(moved);
    found.after[i].last += response[1].row(row).dot(moved);
  }
  const bool seen = found.seen >= kSeen;
  if (Fits(found.now)) {
    found.verdict = seen ? AlignVerdict::kReady : AlignVerdict::kTravelUnseen;
    return;
  }
  // From a part of the travel the rest is too uncertain to be called out of reach.
  const bool helps = !seen || Fits(found.after);
  const bool moves = by_hand || !found.turns.empty();
  found.verdict = helps && moves ? AlignVerdict::kTurn : AlignVerdict::kOutOfReach;
}

}  // namespace abbe::probes
