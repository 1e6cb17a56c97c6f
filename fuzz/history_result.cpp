// `history/figures_of_result.h`: the figures of any JSON are numbers, its curves of one length.
#include <cmath>
#include <nlohmann/json.hpp>

#include "failure/failure.h"
#include "fuzz/target.h"
#include "history/figures_of_result.h"

namespace abbe::fuzz::history_result {

void Read(Bytes bytes) {
  const auto json =
      nlohmann::ordered_json::parse(TextOf(bytes), nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) throw InputError("not JSON");
  const history::Extract extract = history::FiguresOf(json);
  for (const history::Figure& each : extract.figures) {
    Require(std::isfinite(each.value) && !each.quantity.empty(), "a figure has a value");
  }
  for (const history::Curve& each : extract.curves) {
    Require(each.positions_mm.size() == each.value.size(), "a curve has a value a position");
  }
}

}  // namespace abbe::fuzz::history_result
