#include "compensation/corrected_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "compensation/position_table.h"
#include "failure/failure.h"
#include "failure/located.h"

namespace abbe::compensation {

CorrectedTable CorrectTable(std::string_view text, const std::string& file,
                            const Corrector& corrector, const Eigen::Matrix3Xd& beside) {
  CorrectedTable corrected;
  corrected.text.reserve(text.size());
  const std::array<bool, 3> needed{corrector.Has(0), corrector.Has(1), corrector.Has(2)};
  for (PositionTable table(text, file, needed); table.Next(); corrected.text += table.End()) {
    if (!table.IsRow()) {
      corrected.text += table.line();
      continue;
    }
    Eigen::Vector3d made =
        Located(table.Where(), [&] { return corrector.MadeOfReading(table.Position()); });
    if (beside.size() > 0) made += beside.col(corrected.rows);
    corrected.largest = std::max(corrected.largest, (made - table.Position()).norm());
    ++corrected.rows;
    corrected.text += table.WithPosition(made);
  }
  return corrected;
}

}  // namespace abbe::compensation
