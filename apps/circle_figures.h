// The figures of a circle by name, and how well each is known.
//
//   const FigureUncertainties u = UncertaintiesOf(run, shifted, figures, options);
//   u[i].calibration, u[i].noise;       // of kCircleFigures[i], standard uncertainties, m
//
// `calibration` comes from what the calibration of the linkage leaves open: `shifted` holds the run
// as it would be with each independent error of it, and the squares of what they change add up.
// `noise` is what twice the reading noise would change (paths/circle_noise.h), so it holds the
// scatter of a figure and by how much noise makes it too large. Lack of fit of the linkage's model
// is not in it. Units: m. Failure: that of paths::EvaluateCircle.
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
