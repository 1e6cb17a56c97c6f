#include "apps/circle_figures.h"

#include <cmath>
#include <string_view>

#include "paths/circle_noise.h"

namespace abbe::apps {

using paths::CircleFigures;
using paths::CircleRun;

namespace {

constexpr std::uint64_t kCopies = 12;    // of the noise: its effect is estimated to 20 %
const double kDoubles = std::sqrt(3.0);  // noise of this size added to 1 gives 2, in squares

// Figures of the standard need the programmed radius; without it others, with names of their own,
// use the circle of the recorded positions.
Figure Programmed(const CircleFigures& figures, const Figure& value) {
  return figures.is_programmed ? value : Figure();
}
Figure Recorded(const CircleFigures& figures, const Figure& value) {
  return figures.is_programmed ? Figure() : value;
}

}  // namespace

const std::array<CircleFigure, 17> kCircleFigures{{
    {"G_ccw_um", "G(ccw) circular deviation",
     [](const CircleFigures& f) { return f.iso.ccw ? Figure(f.iso.ccw->G) : Figure(); }},
    {"G_cw_um", "G(cw) circular deviation",
     [](const CircleFigures& f) { return f.iso.cw ? Figure(f.iso.cw->G) : Figure(); }},
    {"G_b_um", "G(b) both senses",
     [](const CircleFigures& f) { return f.iso.both ? Figure(f.iso.both->G) : Figure(); }},
    {"G_ccw_ls_um", "G(ccw) about the least-squares centre",
     [](const CircleFigures& f) { return f.iso.ccw ? Figure(f.iso.ccw->G_ls) : Figure(); }},
    {"G_cw_ls_um", "G(cw) about the least-squares centre",
     [](const CircleFigures& f) { return f.iso.cw ? Figure(f.iso.cw->G_ls) : Figure(); }},
    {"G_b_ls_um", "G(b) about the least-squares centre",
     [](const CircleFigures& f) { return f.iso.both ? Figure(f.iso.both->G_ls) : Figure(); }},
    {"F_max_um", "F max, set-up centre",
     [](const CircleFigures& f) { return Programmed(f, f.iso.F_max); }},
    {"F_min_um", "F min, set-up centre",
     [](const CircleFigures& f) { return Programmed(f, f.iso.F_min); }},
    {"F_max_ls_um", "F max, least-squares centre",
     [](const CircleFigures& f) { return Programmed(f, f.iso.F_max_ls); }},
    {"F_min_ls_um", "F min, least-squares centre",
     [](const CircleFigures& f) { return Programmed(f, f.iso.F_min_ls); }},
    {"D_um", "D mean bidirectional radial deviation",
     [](const CircleFigures& f) { return Programmed(f, f.iso.D); }},
    {"largest_beyond_recorded_um", "largest radius minus the recorded one",
     [](const CircleFigures& f) { return Recorded(f, f.iso.F_max); }},
    {"smallest_beyond_recorded_um", "smallest radius minus the recorded one",
     [](const CircleFigures& f) { return Recorded(f, f.iso.F_min); }},
    {"mean_beyond_recorded_um", "mean radius minus the recorded one",
     [](const CircleFigures& f) { return Recorded(f, f.iso.D); }},
    {"rms_ccw_um", "harmonics left out (ccw), rms",
     [](const CircleFigures& f) { return f.ccw ? Figure(f.ccw->rms) : Figure(); }},
    {"rms_cw_um", "harmonics left out (cw), rms",
     [](const CircleFigures& f) { return f.cw ? Figure(f.cw->rms) : Figure(); }},
    {"out_of_plane_um", "out of plane, range",
     [](const CircleFigures& f) {
       return f.out_of_plane > 0.0 ? Figure(f.out_of_plane) : Figure();
     }},
}};

double FigureUncertainty::Total() const { return std::hypot(calibration, noise); }

FigureUncertainties UncertaintiesOf(const CircleRun& run,
                                    const std::vector<const CircleRun*>& shifted,
                                    const CircleFigures& figures,
                                    const paths::FigureOptions& options) {
  FigureUncertainties squares;
  const auto add = [&](const CircleRun& other, double weight, double FigureUncertainty::*part) {
    const CircleFigures changed = paths::EvaluateCircle(other, options);
    for (std::size_t i = 0; i < kCircleFigures.size(); ++i) {
      const Figure before = kCircleFigures[i].of(figures), after = kCircleFigures[i].of(changed);
      if (before && after) squares[i].*part += weight * (*after - *before) * (*after - *before);
    }
  };
  for (const CircleRun* one : shifted) add(*one, 1.0, &FigureUncertainty::calibration);
  const double noise = paths::ReadingNoise(run);
  for (std::uint64_t copy = 0; copy < kCopies && noise > 0.0; ++copy) {
    add(paths::WithNoise(run, kDoubles * noise, copy), 1.0 / kCopies, &FigureUncertainty::noise);
  }
  FigureUncertainties u;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (std::string_view(kCircleFigures[i].key).starts_with("rms")) continue;  // noise itself
    u[i] = {std::sqrt(squares[i].calibration), std::sqrt(squares[i].noise)};
  }
  return u;
}

}  // namespace abbe::apps
