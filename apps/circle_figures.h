// The figures of a circle by name, with their standard uncertainties.
//
//   const FigureUncertainties u = UncertaintiesOf(run, shifted, figures, options);
//   u[i].calibration, u[i].noise;       // of kCircleFigures[i], standard uncertainties, m
//
// `calibration` is the uncertainty from the calibration of the linkage: `shifted` holds the run
// with each independent error of the calibration, and their changes of a figure add up in squares.
// `noise` is the rms change of a figure when the reading noise is doubled (paths/circle_noise.h):
// it contains the scatter of the figure and its bias by noise. Lack of fit of the linkage model is
// not included. Units: m. Failure: that of paths::EvaluateCircle.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "paths/circle_run.h"

namespace abbe::apps {

using Figure = std::optional<double>;  // m

struct CircleFigure {
  const char* key;  // in the data, in um
  const char* text;
  Figure (*of)(const paths::CircleFigures&);
};

extern const std::array<CircleFigure, 17> kCircleFigures;

struct FigureUncertainty {
  double calibration = 0.0, noise = 0.0;
  double Total() const;
};

using FigureUncertainties = std::array<FigureUncertainty, 17>;  // as kCircleFigures

FigureUncertainties UncertaintiesOf(const paths::CircleRun& run,
                                    const std::vector<const paths::CircleRun*>& shifted,
                                    const paths::CircleFigures& figures,
                                    const paths::FigureOptions& options);

}  // namespace abbe::apps
