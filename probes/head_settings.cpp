#include "probes/head_settings.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "failure/failure.h"
#include "machine/direction.h"
#include "probes/head_inversion.h"

namespace abbe::probes {
namespace {

using Eigen::Vector3d;
using settings::Table;

struct NominalProbe {
  const char* table;
  const char* unit;
  double u, v;  // mm; v is s for a top probe, n for a side probe
};
constexpr PerProbe<NominalProbe> kNominal{{{"probe_a", "top", 10.0, 0.0},
                                           {"probe_b", "top", 0.0, 10.0},
                                           {"probe_c", "top", 0.0, -10.0},
                                           {"probe_d", "side", 0.0, 20.0},
                                           {"probe_e", "side", 10.0, 20.0}}};

void ReadProbe(const Table& table, std::size_t i, HeadSettings& head) {
  const NominalProbe& nominal = kNominal[i];
  if (!table.Has("position_mm"))
    head.assumed.insert(fmt::format("head.{}.position_mm", nominal.table));
  if (table.Text("unit", nominal.unit) != nominal.unit) {
    throw table.Error("unit", fmt::format("must be \"{}\": A, B and C look on the top surface, D "
                                          "and E on the side surface",
                                          nominal.unit));
  }
  const auto at = table.Quantities("position_mm", 2, std::vector{nominal.u, nominal.v});
  if (i < kTopProbes) {
    head.layout.top[i] = {at[0], at[1]};
  } else {
    head.layout.side[i - kTopProbes] = {at[0], at[1]};
  }
  ProbeSettings& probe = head.probes[i];
  probe.range = table.Quantity("range_um", {.fallback = 200.0, .above = 0.0});
  if (table.Has("zero_gap_um")) {
    probe.zero_gap = table.Quantity("zero_gap_um", {.above = 0.0});
    if (*probe.zero_gap > probe.range) throw table.Error("zero_gap_um", "is above range_um");
  }
  probe.gain = table.Number("gain", {.fallback = 1.0, .above = 0.0});
  table.RefuseUnknown();
}

HeadTolerance ReadTolerance(const Table& table) {
  const auto deviation = [&](const char* key, double fallback) {
    return table.Quantity(key, {.fallback = fallback, .at_least = 0.0});
  };
  const HeadTolerance tolerance{.probe_position = deviation("probe_position_um", 10.0),
                                .installation = deviation("installation_urad", 500.0),
                                .offset = deviation("installation_um", 50.0),
                                .gain = deviation("gain_ppm", 500.0),
                                .linearity = deviation("linearity_um", 0.0)};
  table.RefuseUnknown();
  return tolerance;
}

Installation<> ReadInstallation(const Table& table) {
  const auto zero = [&](const char* key) { return table.Quantity(key, {.fallback = 0.0}); };
  const Installation<> installation{.roll = zero("roll_urad"),
                                    .pitch = zero("pitch_urad"),
                                    .yaw = zero("yaw_urad"),
                                    .du = zero("du_um"),
                                    .ds = zero("ds_um"),
                                    .dn = zero("dn_um")};
  table.RefuseUnknown();
  return installation;
}

AxisFrame ReadFrame(const Table& table, int axis) {
  static const std::array<std::vector<std::string>, 3> kDefault{
      {{"x", "y", "z"}, {"y", "-x", "z"}, {"z", "y", "-x"}}};
  AxisFrame frame;
  frame.R_MH = machine::ReadRotation(table, kDefault[axis]);
  if (frame.R_MH.col(0) != Vector3d::Unit(axis)) {
    throw table.Error(
        "rotation",
        fmt::format("must begin with \"{}\": u points along the swept axis", kDefault[axis][0]));
  }
  const auto at = table.Quantities("position_mm", 3, std::vector{0.0, 0.0, 0.0});
  frame.p_MH = Vector3d(at[0], at[1], at[2]);
  table.RefuseUnknown();
  return frame;
}

}  // namespace

HeadSettings ReadHeadSettings(const Table& root) {
  const Table table = root.Child("head");
  HeadSettings head;
  for (std::size_t i = 0; i < kProbes; ++i) ReadProbe(table.Child(kNominal[i].table), i, head);
  head.electrode = {
      .radius = table.Quantity("electrode_radius_mm", {.fallback = 0.0, .at_least = 0.0}),
      .stray = table.Quantity("stray_per_mm", {.fallback = 0.0, .at_least = 0.0})};
  try {
    const SimplifiedInversion separates(head.layout, MovingBody::kHead);
  } catch (const InputError& failure) {
    throw table.Error("", failure.what());
  }
  if (!table.Child("tolerance").Has("linearity_um")) {
    head.assumed.insert("head.tolerance.linearity_um");
  }
  head.tolerance = ReadTolerance(table.Child("tolerance"));
  head.installation = ReadInstallation(table.Child("installation"));
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("axis_{}", "XYZ"[axis]);
    const Table frame = table.Child(name);
    for (const char* key : {"position_mm", "rotation"}) {
      if (!frame.Has(key)) head.assumed.insert(fmt::format("head.{}.{}", name, key));
    }
    head.axes[axis] = ReadFrame(frame, axis);
  }
  table.RefuseUnknown();
  return head;
}

TargetSettings ReadTargetSettings(const Table& root) {
  const Table table = root.Child("target");
  const TargetSettings target{
      .form = table.Quantity("form_nm", {.fallback = 10.0, .at_least = 0.0}),
      .form_known_to = table.Number("form_known_to", {.fallback = kKnownTo, .at_least = 1.0}),
      .form_length = table.Quantity("form_length_mm", {.fallback = 15.0, .above = 0.0}),
      .squareness = table.Quantity("squareness_urad", {.fallback = 0.0}),
      .u_squareness = table.Quantity("u_squareness_urad", {.fallback = 0.0, .at_least = 0.0})};
  table.RefuseUnknown();
  return target;
}

ProbeNoise ReadProbeNoise(const Table& root) {
  const Table table = root.Child("noise");
  const ProbeNoise noise{
      .probe = table.Quantity("probe_nm", {.fallback = 20.0, .at_least = 0.0}),
      .drift = table.Quantity("drift_nm", {.fallback = 30.0, .at_least = 0.0}),
      .drift_time = table.Quantity("drift_time_s", {.fallback = 600.0, .above = 0.0})};
  table.RefuseUnknown();
  return noise;
}

}  // namespace abbe::probes
