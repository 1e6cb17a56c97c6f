#include "apps/calibration_tables.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "apps/parameters_json.h"
#include "relm/error_model_name.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;

using settings::kMicro;
constexpr double kMilli = 1e-3;
constexpr std::size_t kMostOutliers = 10;
constexpr double kNoticed = 1.5;  // residuals over stated noise: above it the table has a warning

ordered_json Json(const fusion::Distances& distances) {
  return {{"rms_um", distances.rms / kMicro}, {"max_um", distances.max / kMicro}};
}

ordered_json InMicrometres(const Eigen::Vector3d& v) {
  return {v.x() / kMicro, v.y() / kMicro, v.z() / kMicro};
}

ordered_json Json(const fusion::PoseResidual& residual,
                  const std::vector<simulation::LinkageRun>& runs) {
  const auto at = runs[residual.run].reference.col(residual.pose);
  return {{"recording", runs[residual.run].name},
          {"row", residual.row + 1},
          {"position_mm", {at.x() / kMilli, at.y() / kMilli, at.z() / kMilli}},
          {"before_um", InMicrometres(residual.before)},
          {"gap_um", InMicrometres(residual.gap)},
          {"held_out_um", InMicrometres(residual.held_out)},
          {"normalised", residual.normalised}};
}

std::string Spread(const char* what, const fusion::Distances& distances) {
  return fmt::format("  {:<34}{:>10.3f}{:>10.3f}\n", what, distances.rms / kMicro,
                     distances.max / kMicro);
}

std::string ParameterTable(const estimation::Result& fit) {
  std::string text = fmt::format("\n{:<30}{:>12}{:>12}{:>12}{:>10}  {:<9}{}\n", "parameter",
                                 "value", "uncertainty", "nominal", "prior", "unit", "seen by");
  for (const auto& block : fit.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto& entry = block.entries[i];
      const auto printed = [&](double value) { return value / block.unit.si; };
      text += fmt::format("{:<30}{:>12.4f}{:>12.4f}{:>12.4f}{:>10.3g}  {:<9}{}\n",
                          block.FullName(i), printed(entry.value), printed(entry.uncertainty),
                          printed(entry.nominal), printed(entry.prior_sd), block.unit.name,
                          estimation::Name(fit.Seen(block.FullName(i))));
    }
  }
  return text;
}

std::string Outliers(const fusion::CalibrationReport& report,
                     const std::vector<simulation::LinkageRun>& runs) {
  if (report.outliers.empty()) return "";
  std::string text =
      fmt::format("\n{} poses are outliers and have little weight:\n", report.outliers.size());
  for (std::size_t i = 0; i < std::min(kMostOutliers, report.outliers.size()); ++i) {
    const auto& outlier = report.outliers[i];
    text +=
        fmt::format("  {} row {}: {:.2f} um, {:.1f} standard deviations\n", runs[outlier.run].name,
                    outlier.row + 1, outlier.gap.norm() / kMicro, outlier.normalised);
  }
  return text;
}

// Largest 2D or 3D deviations in um that Boelens (2006) reports for the step.
std::string Published(const std::string& name) {
  if (name == "reference") return "circle 2.19 (2D)";
  if (name == "nominal") return "349 (3D)";
  if (name == "published") return "5.10 (3D), circle 5.29 (2D)";
  if (name == "published, one cell") return "circle 5.96 (2D)";
  if (name == "published, mapped") return "circle 5.22 (2D)";
  if (name == "published-with-bearing") return "circle 4.19 (2D)";
  if (name == "published-with-bearing, mapped") return "circle 5.02 (2D)";
  return "";
}

// Micrometres in a column; a dash if there is no number.
std::string Cell(double metres, int width) {
  const std::string text = std::isfinite(metres) ? fmt::format("{:.3f}", metres / kMicro) : "-";
  return fmt::format("{:>{}}", text, width);
}

// What the fit counts as noise beside what the machine file states.
std::string NoiseCounted(const fusion::CalibrationReport& report,
                         const std::vector<simulation::LinkageRun>& runs) {
  std::string text;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const simulation::RunNoise& noise = report.noise[r];
    if (noise.memory) {
      text += fmt::format(
          "\n{}: residuals go on from pose to pose, {:.2g} times the stated noise, remembered for "
          "{:.3g} s: the reference or the linkage drifts, or the model leaves something out; the "
          "uncertainties count it.\n",
          runs[r].name, noise.memory->slow, noise.memory->time);
    } else if (noise.deviation > kNoticed) {
      text += fmt::format(
          "\n{}: residuals are {:.1f} times the stated noise: the reference or the model is worse "
          "than [linkage.noise]; the uncertainties count it.\n",
          runs[r].name, noise.deviation);
    }
  }
  return text;
}

// Over what the machine file states.
ordered_json NoiseJson(const std::vector<simulation::RunNoise>& noise) {
  ordered_json all = ordered_json::array();
  for (const simulation::RunNoise& one : noise) {
    ordered_json json{{"white", one.memory ? one.memory->white : one.deviation}};
    if (one.memory) json.update({{"slow", one.memory->slow}, {"time_s", one.memory->time}});
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace

ordered_json CalibrationJson(const fusion::CalibrationReport& report,
                             const std::vector<simulation::LinkageRun>& runs) {
  ordered_json unseen = ordered_json::array();
  for (const auto& weak : report.seen.unseen) {
    unseen.push_back({{"words", weak.words}, {"share_of_prior", weak.ratio}});
  }
  ordered_json residuals = ordered_json::array(), outliers = ordered_json::array();
  for (const auto& residual : report.residuals) residuals.push_back(Json(residual, runs));
  for (const auto& outlier : report.outliers) outliers.push_back(Json(outlier, runs));
  ordered_json recordings = ordered_json::array();
  for (const auto& run : runs) {
    recordings.push_back(std::filesystem::path(run.name).filename().string());
  }
  ordered_json result{{"abbe", ABBE_VERSION},
                      {"command", "calibrate"},
                      {"kind", "calibration"},
                      {"recordings", recordings},
                      {"machine", report.calibration.machine},
                      {"model", relm::ErrorModelName(report.calibration.model)},
                      {"displacement", report.calibration.displacement},
                      {"poses", report.residuals.size()},
                      {"before", Json(report.before)},
                      {"after", Json(report.after)},
                      {"held_out", Json(report.held_out)},
                      {"residuals_over_noise", report.excess},
                      {"noise", NoiseJson(report.noise)},
                      {"combinations", report.seen.parameters},
                      {"combinations_seen", report.seen.rank},
                      {"scaled_condition", report.seen.condition},
                      {"noise_amplification_index", report.seen.noise_amplification},
                      {"parameters", ParametersJson(report.fit)},
                      {"unseen", unseen},
                      {"residuals", residuals},
                      {"outliers", outliers}};
  if (report.calibration.mapped) {
    const auto& centres = report.calibration.mapped->centres;
    result["mapped"] = {{"cells", report.calibration.mapped->values.size()},
                        {"centres_m", {centres[0], centres[1], centres[2]}}};
    for (const auto& shift : report.cell_shifts.colwise()) {
      result["mapped"]["shifts_um"].push_back(InMicrometres(shift));
    }
  }
  return result;
}

std::string CalibrationTable(const fusion::CalibrationReport& report,
                             const std::vector<simulation::LinkageRun>& runs) {
  std::string text = fmt::format(
      "Linkage calibrated with {} poses of {} recordings, model \"{}\"{}, {} parameters free.\n\n"
      "  ball position, 3D, um                    rms       max\n",
      report.residuals.size(), runs.size(), relm::ErrorModelName(report.calibration.model),
      report.calibration.displacement ? ", displacement form" : "", report.seen.parameters);
  text += Spread("nominal linkage, displacements", report.before);
  text += Spread("calibrated", report.after);
  if (std::isfinite(report.held_out.rms))
    text += Spread("calibrated, poses held out", report.held_out);
  if (report.calibration.mapped) {
    text += fmt::format("  mapped with {} cells\n", report.calibration.mapped->values.size());
  }
  text += ParameterTable(report.fit) + "\n" + SeenTable(report.seen) + Outliers(report, runs);
  text += NoiseCounted(report, runs);
  for (const auto& run : runs) {
    if (run.referenced[0] && run.referenced[1] && run.referenced[2]) continue;
    text += fmt::format(
        "\n{}: no reference instrument in every direction: errors of the machine itself went into "
        "the parameters.\n",
        run.name);
  }
  return text;
}

std::string SeenTable(const fusion::Observability& seen) {
  std::string text = fmt::format(
      "The data see {} of {} combinations of parameters; scaled condition {:.3g}, noise "
      "amplification index {:.3g}.\n",
      seen.rank, seen.parameters, seen.condition, seen.noise_amplification);
  if (seen.unseen.empty()) return text;
  text += "Not seen (in units of the priors; remaining share of the prior standard deviation):\n";
  for (const auto& weak : seen.unseen) {
    text += fmt::format("  {:4.0f} %  {}\n", 100.0 * weak.ratio, weak.words);
  }
  return text;
}

ordered_json ComparisonJson(const std::vector<fusion::ComparedModel>& rows) {
  ordered_json models = ordered_json::array();
  for (const auto& row : rows) {
    ordered_json checks = ordered_json::array();
    for (const auto& check : row.checks) {
      checks.push_back({{"distance", Json(check.distance)}, {"circle_um", check.circle / kMicro}});
    }
    models.push_back({{"name", row.name},
                      {"parameters", row.parameters},
                      {"after", Json(row.after)},
                      {"held_out", Json(row.held_out)},
                      {"checks", checks},
                      {"published", Published(row.name)}});
  }
  return models;
}

std::string ComparisonTable(const std::vector<fusion::ComparedModel>& rows) {
  std::string text = fmt::format("{:<34}{:>6}{:>10}{:>10}{:>10}", "model, 3D in um", "free", "rms",
                                 "held out", "max");
  for (std::size_t i = 0; i < rows.front().checks.size(); ++i) {
    text += fmt::format("{:>12}{:>10}", fmt::format("check {} max", i + 1), "circle");
  }
  text += "  Boelens 2006, largest\n";
  for (const auto& row : rows) {
    text += fmt::format("{:<34}{:>6}", row.name, row.parameters) + Cell(row.after.rms, 10) +
            Cell(row.held_out.rms, 10) + Cell(row.held_out.max, 10);
    for (const auto& check : row.checks) {
      text += Cell(check.distance.max, 12) + Cell(check.circle, 10);
    }
    text += fmt::format("  {}\n", Published(row.name));
  }
  return text;
}

std::string EnoughTable(const std::vector<fusion::EnoughRow>& rows, double reading_noise) {
  std::string text = fmt::format(
      "Uncertainty that the calibration leaves in ball positions (3D rms, um); a reading alone has "
      "{:.3f}.\n{:>8}{:>12}{:>12}\n",
      reading_noise / kMicro, "poses", "chosen", "evenly");
  bool is_shown = false;
  for (const auto& row : rows) {
    text += fmt::format(
        "{:>8}{:>12.3f}{:>12.3f}{}\n", row.poses, row.tip_rms / kMicro, row.even_rms / kMicro,
        row.enough && !is_shown ? "  enough: adds less than 10 % to a reading" : "");
    is_shown = is_shown || row.enough;
  }
  if (!is_shown) text += "None of these is sufficient; use more poses or a better reference.\n";
  return text;
}

std::string VolumeTable(const std::vector<fusion::VolumeRow>& rows) {
  std::string text = fmt::format(
      "Uncertainty that a calibration leaves in ball positions (3D rms, um)\n{:>22}{:>12}{:>14}"
      "{:>8}{:>8}{:>12}{:>12}\n",
      "volume mm", "grid", "spacing mm", "poses", "seen", "inside", "travel");
  for (const auto& row : rows) {
    const Eigen::Vector3d mm = row.size / kMilli;
    text += fmt::format("{:>22}{:>12}{:>14.2f}{:>8}{:>8}{:>12.3f}{:>12.3f}\n",
                        fmt::format("{:g} x {:g} x {:g}", mm.x(), mm.y(), mm.z()),
                        fmt::format("{}x{}x{}", row.points.x(), row.points.y(), row.points.z()),
                        mm.x() / (row.points.x() - 1), row.poses, row.rank, row.inside_rms / kMicro,
                        row.travel_rms / kMicro);
  }
  return text;
}

}  // namespace abbe::apps
