#include "rig/linkage_settings.h"

#include "rig/rig_settings.h"

namespace abbe::rig {
namespace {

using settings::Table;

std::vector<int> OrdersOf(const Table& table, const char* key, const std::vector<double>& usual) {
  std::vector<int> orders;
  for (const double order : table.Quantities(key, 0, usual)) {
    orders.push_back(static_cast<int>(order));
  }
  return orders;
}

double Deviation(const Table& table, const char* key, double usual) {
  return table.Quantity(key, {.fallback = usual, .at_least = 0.0});
}

void ReadPopulation(const Table& sd, LinkageSettings& linkage) {
  linkage.link = Deviation(sd, "link_um", 100.0);
  linkage.pivot_angle = Deviation(sd, "pivot_urad", 500.0);
  linkage.pivot_offset = Deviation(sd, "pivot_um", 20.0);
  linkage.encoder_offset = Deviation(sd, "encoder_offset_urad", 1000.0);
  linkage.eccentricity = Deviation(sd, "eccentricity_urad", 20.0);
  linkage.graduation = Deviation(sd, "graduation_urad", 3.0);
  linkage.bearing = Deviation(sd, "bearing_um", 1.0);
  linkage.base_place = Deviation(sd, "base_um", 500.0);
  linkage.base_angle = Deviation(sd, "base_urad", 2000.0);
  linkage.ball = Deviation(sd, "ball_um", 20.0);
  linkage.compliance = Deviation(sd, "compliance_urad", 20.0);
  linkage.thermal = Deviation(sd, "thermal_ppm_per_c", 1.0);
  linkage.seat = Deviation(sd, "seat_um", 0.0);
}

}  // namespace

LinkageSettings ReadLinkage(const Table& root) {
  const Table table = root.Child("linkage");
  if (table.Choice("form", {"pivots", "segments", "denavit-hartenberg", "axes"}) != "pivots") {
    throw table.Error("form", "the rig builds linkages of the form \"pivots\" only");
  }
  LinkageSettings linkage;
  linkage.link_1 = table.Quantity("link_1_mm", {.fallback = 120.0, .above = 0.0});
  linkage.link_2 = table.Quantity("link_2_mm", {.fallback = 120.0, .above = 0.0});
  linkage.elbow_up = table.Choice("elbow", {"up", "down"}) == "up";
  linkage.reach_over = table.Truth("reach_over", false);
  const Table base = table.Child("base");
  const auto place = base.Quantities("position_mm", 3);
  linkage.base_position = Eigen::Vector3d(place[0], place[1], place[2]);
  const auto names = base.Texts("rotation", 3, std::vector<std::string>{"x", "y", "z"});
  for (int i = 0; i < 3; ++i) {
    linkage.base_rotation.col(i) = DirectionOf(base, "rotation", names[i]);
  }
  if (linkage.base_rotation.determinant() < 0.5) {
    throw base.Error("rotation", "must be right-handed: x, y and then z = x cross y");
  }
  linkage.down = DirectionOf(table, "down", table.Text("down", "-z"));
  linkage.expansion = table.Quantity("expansion_ppm_per_c", {.fallback = 11.5});
  linkage.reference_temperature = table.Quantity("reference_c", {.fallback = 20.0});
  linkage.temperature = table.Text("temperature", "");
  linkage.bearing_harmonics = OrdersOf(table, "bearing_harmonics", {1, 2});
  linkage.graduation_harmonics = OrdersOf(table, "graduation_harmonics", {2, 3});
  ReadPopulation(table.Child("tolerance"), linkage);
  const Table noise = table.Child("noise");
  linkage.encoder_noise = Deviation(noise, "encoder_urad", 3.0);
  linkage.reference_noise = Deviation(noise, "reference_um", 0.3);
  linkage.repeatability = Deviation(noise, "repeatability_um", 0.0);
  return linkage;
}

}  // namespace abbe::rig
