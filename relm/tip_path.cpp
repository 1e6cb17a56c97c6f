#include "relm/tip_path.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "failure/failure.h"
#include "recording/good_rows.h"

namespace abbe::relm {
namespace {

using Column = std::span<const double>;

std::vector<Column> AngleColumns(const recording::Recording& recording, Eigen::Index joints) {
  std::vector<Column> columns;
  for (Eigen::Index i = 0; i < joints; ++i) {
    columns.push_back(recording.At(fmt::format("pivot_{}_rad", i + 1)));
  }
  if (recording.Find(fmt::format("pivot_{}_rad", joints + 1))) {
    throw InputError(fmt::format(
        "{}: has a column pivot_{}_rad, but the linkage of the machine file has {} pivots",
        recording.name, joints + 1, joints));
  }
  return columns;
}

// The temperature of the links; empty when the settings name no column or the recording lacks it.
Column TemperatureColumn(const recording::Recording& recording, const LinkageSettings& settings) {
  if (settings.temperature.empty()) return {};
  return recording.Find(settings.temperature).value_or(Column{});
}

double Finite(const recording::Recording& recording, Column column, std::size_t row,
              const std::string& name) {
  if (std::isfinite(column[row])) return column[row];
  throw InputError(fmt::format("{}: row {}: {} is no number and has no flag", recording.name,
                               recording.first_row + row + 1, name));
}

// Rows that are poses of their own: of stated order but unknown times, or of an arm that no machine
// moves along.
bool ArePoses(const recording::Recording& recording) {
  return recording.HeaderText("time").value_or("") == "order" ||
         (recording.Find("ref_x_mm") && !recording.Find("x_mm"));
}

// An encoder turns by less than half a turn from row to row, or its counter has wrapped or slipped.
void RefuseJump(const recording::Recording& recording, const GoodReadings& good,
                Eigen::Index pose) {
  if (pose == 0 || ArePoses(recording)) return;
  const auto step = good.readings.angles.col(pose) - good.readings.angles.col(pose - 1);
  Eigen::Index joint = 0;
  const double largest = step.cwiseAbs().maxCoeff(&joint);
  if (largest <= std::numbers::pi) return;
  throw InputError(fmt::format(
      "{}: row {}: pivot_{}_rad jumps by {:.4f} rad: the encoder's counter has wrapped or slipped; "
      "check counts_per_turn and the range of the node, and record again",
      recording.name, recording.first_row + good.rows[pose] + 1, joint + 1, step[joint]));
}

}  // namespace

GoodReadings ReadAngles(const recording::Recording& recording, const LinkageSettings& settings) {
  const std::vector<Column> columns = AngleColumns(recording, settings.chain.joints());
  const Column temperatures = TemperatureColumn(recording, settings);
  GoodReadings good;
  good.rows = recording::GoodRows(recording);
  good.flagged = recording.rows() - good.rows.size();
  good.readings.angles.resize(settings.chain.joints(), good.rows.size());
  if (!temperatures.empty()) good.readings.warmth.resize(good.readings.poses());
  for (Eigen::Index pose = 0; pose < good.readings.poses(); ++pose) {
    const std::size_t row = good.rows[pose];
    for (Eigen::Index i = 0; i < good.readings.angles.rows(); ++i) {
      good.readings.angles(i, pose) =
          Finite(recording, columns[i], row, fmt::format("pivot_{}_rad", i + 1));
    }
    if (!temperatures.empty()) {
      good.readings.warmth[pose] = Finite(recording, temperatures, row, settings.temperature) -
                                   settings.reference_temperature;
    }
    RefuseJump(recording, good, pose);
  }
  return good;
}

TipPath EvaluateTipPath(const recording::Recording& recording, const LinkageSettings& settings,
                        const LinkageModel& model, const Eigen::VectorXd& x) {
  GoodReadings good = ReadAngles(recording, settings);
  TipPath path{{}, std::move(good.rows), good.flagged};
  model.Tips(good.readings, x, path.tips);
  return path;
}

Eigen::Matrix3Xd InFrame(const geometry::Transform<double>& X_AB, const Eigen::Matrix3Xd& p_BT) {
  return (X_AB.R * p_BT).colwise() + X_AB.p;
}

}  // namespace abbe::relm
