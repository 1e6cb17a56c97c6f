#include "relm/linkage_settings.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "machine/direction.h"
#include "relm/error_models.h"

namespace abbe::relm {
namespace {

using Eigen::Vector3d;
using settings::Table;

constexpr double kRightAngle = std::numbers::pi / 2;

Vector3d Triple(const std::vector<double>& values) { return Vector3d(values.data()); }

geometry::Transform<double> ReadBase(const Table& table) {
  geometry::Transform<double> X_MB;
  X_MB.p = Triple(table.Quantities("position_mm", 3));
  X_MB.R = machine::ReadRotation(table, {"x", "y", "z"});
  table.RefuseUnknown();
  return X_MB;
}

LinkageTolerance ReadTolerance(const Table& table) {
  const auto deviation = [&](const char* key, double fallback) {
    return table.Quantity(key, {.fallback = fallback, .at_least = 0.0});
  };
  const LinkageTolerance tolerance{.link = deviation("link_um", 100.0),
                                   .pivot_angle = deviation("pivot_urad", 500.0),
                                   .pivot_offset = deviation("pivot_um", 20.0),
                                   .encoder_offset = deviation("encoder_offset_urad", 1000.0),
                                   .eccentricity = deviation("eccentricity_urad", 20.0),
                                   .graduation = deviation("graduation_urad", 3.0),
                                   .bearing = deviation("bearing_um", 1.0),
                                   .base_position = deviation("base_um", 500.0),
                                   .base_angle = deviation("base_urad", 2000.0),
                                   .ball = deviation("ball_um", 20.0),
                                   .compliance = deviation("compliance_urad", 20.0),
                                   .thermal = deviation("thermal_ppm_per_c", 1.0),
                                   .seat = deviation("seat_um", 0.0)};
  table.RefuseUnknown();
  return tolerance;
}

LinkageNoise ReadNoise(const Table& table) {
  const LinkageNoise noise{
      .encoder = table.Quantity("encoder_urad", {.fallback = 3.0, .at_least = 0.0}),
      .reference = table.Quantity("reference_um", {.fallback = 0.3, .at_least = 0.0}),
      .machine = table.Quantity("machine_um", {.fallback = 5.0, .at_least = 0.0}),
      .repeatability = table.Quantity("repeatability_um", {.fallback = 0.0, .at_least = 0.0})};
  table.RefuseUnknown();
  return noise;
}

std::vector<int> ReadOrders(const Table& table, const char* key,
                            const std::vector<double>& by_default) {
  std::vector<int> orders;
  for (const double value : table.Quantities(key, 0, by_default)) {
    if (!(value >= 1 && value <= 64 && value == std::floor(value))) {
      throw table.Error(key, "must hold whole numbers from 1 to 64: the harmonics per turn");
    }
    orders.push_back(static_cast<int>(value));
  }
  return orders;
}

// Two links and three pivots as six segments with the encoders on theta 0, phi 2 and phi 4. The
// segments 1, 3 and 5 have zero length: pivot 2 beside pivot 1, pivot 3 above the end of link 1,
// and the ball beside link 2, along the axis of pivot 3.
std::vector<Segment> SegmentsOf(const PivotLinkage& linkage) {
  return {{.encoder = SegmentEncoder::kTheta},
          {.phi = kRightAngle},
          {.length = linkage.link_1(), .encoder = SegmentEncoder::kPhi},
          {.phi = -kRightAngle},
          {.length = linkage.link_2(), .encoder = SegmentEncoder::kPhi},
          {.theta = kRightAngle, .phi = kRightAngle}};
}

std::vector<Segment> ReadSegments(const Table& linkage) {
  std::vector<Segment> segments;
  for (const Table& table : linkage.Children("segment")) {
    const std::string encoder = table.Choice("encoder", {"none", "theta", "phi"});
    segments.push_back({.length = table.Quantity("length_mm", {.fallback = 0.0, .at_least = 0.0}),
                        .theta = table.Quantity("theta_deg", {.fallback = 0.0}),
                        .phi = table.Quantity("phi_deg", {.fallback = 0.0}),
                        .encoder = encoder == "theta" ? SegmentEncoder::kTheta
                                   : encoder == "phi" ? SegmentEncoder::kPhi
                                                      : SegmentEncoder::kNone});
    table.RefuseUnknown();
  }
  return segments;
}

std::vector<DenavitHartenbergRow> ReadRows(const Table& linkage) {
  std::vector<DenavitHartenbergRow> rows;
  for (const Table& table : linkage.Children("joint")) {
    rows.push_back({.theta = table.Quantity("theta_deg", {.fallback = 0.0}),
                    .d = table.Quantity("d_mm", {.fallback = 0.0}),
                    .a = table.Quantity("a_mm", {.fallback = 0.0}),
                    .alpha = table.Quantity("alpha_deg", {.fallback = 0.0}),
                    .fixed = table.Truth("fixed", false)});
    table.RefuseUnknown();
  }
  return rows;
}

SerialChain ReadAxes(const Table& linkage) {
  std::vector<JointAxis> axes;
  for (const Table& table : linkage.Children("axis")) {
    axes.push_back(
        {Triple(table.Quantities("point_mm", 3)), Triple(table.Quantities("direction", 3))});
    table.RefuseUnknown();
  }
  return SerialChain(std::move(axes), Triple(linkage.Quantities("ball_mm", 3)));
}

// The chain of one of the forms, with its closed form and segments where it has them.
struct Form {
  std::optional<PivotLinkage> pivots;
  std::vector<Segment> segments;
  SerialChain chain;
  std::vector<DenavitHartenbergRow> rows = {};
  Vector3d p_nT = Vector3d::Zero();
};

Form ReadForm(const Table& table) {
  const std::string form =
      table.Choice("form", {"pivots", "segments", "denavit-hartenberg", "axes"});
  try {
    if (form == "pivots") {
      const PivotLinkage pivots(table.Quantity("link_1_mm", {.fallback = 120.0, .above = 0.0}),
                                table.Quantity("link_2_mm", {.fallback = 120.0, .above = 0.0}));
      const auto segments = SegmentsOf(pivots);
      return {pivots, segments, SerialChain::FromSegments(segments)};
    }
    if (form == "segments") {
      const auto segments = ReadSegments(table);
      return {std::nullopt, segments, SerialChain::FromSegments(segments)};
    }
    if (form == "axes") return {std::nullopt, {}, ReadAxes(table)};
    const auto rows = ReadRows(table);
    const Vector3d p_nT = Triple(table.Quantities("ball_mm", 3, std::vector{0.0, 0.0, 0.0}));
    return {std::nullopt, {}, SerialChain::FromDenavitHartenberg(rows, {}, p_nT), rows, p_nT};
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    constexpr std::string_view kOwn = "linkage: ";  // prefix of the chain, which has no file
    if (!message.starts_with(kOwn)) throw;
    throw table.Error("", message.substr(kOwn.size()));
  }
}

std::vector<Mass> ReadMasses(const Table& linkage, Eigen::Index joints) {
  std::vector<Mass> masses;
  for (const Table& table : linkage.Children("mass")) {
    const auto after = table.Integer("after_pivot", {.at_least = 1.0});
    if (after > joints) {
      throw table.Error("after_pivot", fmt::format("must be 1 to {}: the pivots", joints));
    }
    masses.push_back({.kg = table.Number("kg", {.above = 0.0}),
                      .carrier = after - 1,
                      .point = Triple(table.Quantities("point_mm", 3))});
    table.RefuseUnknown();
  }
  return masses;
}

}  // namespace

LinkageSettings ReadLinkageSettings(const Table& root) {
  const Table table = root.Child("linkage");
  Form form = ReadForm(table);
  LinkageSettings linkage{
      .chain = std::move(form.chain),
      .rows = std::move(form.rows),
      .p_nT = form.p_nT,
      .masses = {},
      .pivots = form.pivots,
      .branch = {},
      .segments = std::move(form.segments),
      .X_MB = ReadBase(table.Child("base")),
      .down_M = machine::ReadDirection(table, "down", "-z"),
      .expansion = table.Quantity("expansion_ppm_per_c", {.fallback = 11.5}),
      .reference_temperature = table.Quantity("reference_c", {.fallback = 20.0}),
      .temperature = table.Text("temperature", ""),
      .bearing_harmonics = ReadOrders(table, "bearing_harmonics", {1, 2}),
      .graduation_harmonics = ReadOrders(table, "graduation_harmonics", {2, 3}),
      .tolerance = ReadTolerance(table.Child("tolerance")),
      .noise = ReadNoise(table.Child("noise"))};
  linkage.masses = ReadMasses(table, linkage.chain.joints());
  if (linkage.pivots) {
    linkage.branch.elbow =
        table.Choice("elbow", {"up", "down"}) == "up" ? Elbow::kUp : Elbow::kDown;
    linkage.branch.reach_over = table.Truth("reach_over", false);
  }
  table.RefuseUnknown();
  return linkage;
}

Vector3d NominalTip(const machine::Chain& chain, const Vector3d& axis_positions) {
  return chain.ToolSenses().cwiseProduct(axis_positions);
}

LinkageModel MakeLinkageModel(const LinkageSettings& settings, ErrorModel model) {
  switch (model) {
    case ErrorModel::kPivots:
      return PivotErrorModel(settings);
    case ErrorModel::kPublished:
      return PublishedErrorModel(settings, false);
    case ErrorModel::kPublishedWithBearing:
      return PublishedErrorModel(settings, true);
    default:
      return CompleteErrorModel(settings);
  }
}

}  // namespace abbe::relm
