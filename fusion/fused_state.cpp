#include "fusion/fused_state.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "fusion/machine_problem.h"
#include "fusion/marginal.h"

namespace abbe::fusion {

map::MapState StateAfter(const estimation::Result& fit, const estimation::Layout& layout,
                         const estimation::Linearization& at,
                         const std::vector<estimation::ParameterBlock>& of_model,
                         const std::vector<simulation::SimulatedRun>& runs,
                         const Eigen::MatrixXd& of_map) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();  // of an uncertainty
  map::MapState state;
  std::vector<double> values;
  const std::vector<std::string>& names = layout.names;
  std::vector<int> columns = ColumnsOf(names, of_model);
  const std::set<int> machine(columns.begin(), columns.end());
  for (const auto& block : fit.blocks) {
    if (!OutlivesRuns(block, runs)) continue;
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto name = std::find(names.begin(), names.end(), block.FullName(i));
      const int column = static_cast<int>(name - names.begin());
      const double u = block.entries[i].uncertainty;
      if (name == names.end() || machine.contains(column) || !(u > 0.0 && u < kUnknown)) continue;
      columns.push_back(column);
      state.names.push_back(*name);
      values.push_back(block.entries[i].value);
    }
  }
  Eigen::MatrixXd all = at.prior.information;
  for (const auto& source : at.sources) all += source.information;
  state.values = Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  state.covariance = MarginalCovariance(all, columns);
  state.covariance.topLeftCorner(of_map.rows(), of_map.cols()) = of_map;
  return state;
}

}  // namespace abbe::fusion
