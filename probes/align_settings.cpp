#include "probes/align_settings.h"

#include "machine/direction.h"

namespace abbe::probes {
namespace {

Screw ReadScrew(const settings::Table& table) {
  Screw screw;
  screw.name = table.key();
  screw.body = table.Choice("body", {"target", "head"}) == "head" ? ScrewedBody::kHead
                                                                  : ScrewedBody::kTarget;
  screw.direction = machine::ReadDirection(table, "clockwise", "z");
  screw.pitch = table.Quantity("pitch_mm", {.at_least = 0.0});
  const auto place = table.Quantities("position_mm", 3);
  screw.place = Eigen::Vector3d(place[0], place[1], place[2]);
  table.RefuseUnknown();
  return screw;
}

}  // namespace

AlignSettings ReadAlignSettings(const settings::Table& root) {
  const settings::Table table = root.Child("align");
  AlignSettings settings{
      .margin = table.Quantity("margin_um", {.fallback = 20.0, .at_least = 0.0}),
      .motion = table.Quantity("error_motion_um", {.fallback = 2.0, .above = 0.0}),
      .screws = {}};
  for (const settings::Table& screw : table.Child("screw").Named()) {
    settings.screws.push_back(ReadScrew(screw));
  }
  table.RefuseUnknown();
  return settings;
}

}  // namespace abbe::probes
