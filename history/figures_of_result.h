// What a history takes out of a result (the JSON of a command, docs/history.md): figures, curves
// and findings.
//
//   const Extract extract = FiguresOf(result);
//   for (const Figure& each : extract.figures) fmt::print("{} {}\n", each.Name(), each.value);
//
// Every kind of result has a reader in one of result_*.cpp; a kind without one gives nothing. A key
// that is absent leaves out its figures.
//
// Frames: positions count as the control counts, signs are those of the result. Shapes: curves as
// in history/figure.h; a number that the result lacks is NaN. Units: lengths in um, angles in urad.
// Failure: none is thrown; where a key has another form than in docs/report.md, `trouble` says so
// and the result gives no figures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "history/figure.h"

namespace abbe::history {

struct Extract {
  std::vector<Figure> figures;
  std::vector<Curve> curves;
  std::vector<Finding> findings;
  std::string verdict;  // of a diagnosis
  std::string trouble;
};

Extract FiguresOf(const nlohmann::ordered_json& result);

// Where the figures of a sweep were measured, which a store does not hold. `content`: of the result.
void AddStations(const std::string& content, Extract& extract);

}  // namespace abbe::history
