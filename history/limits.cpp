#include "history/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "settings/nearest_word.h"
#include "settings/unit.h"

namespace abbe::history {
namespace {

using Names = std::vector<std::string>;

const Names kOfAxis{"positioning_A_um", "positioning_R_um",    "positioning_E_um",
                    "positioning_M_um", "positioning_B_um",    "positioning_reversal_um",
                    "stepping_um",      "side_straightness_um"};
const Names kOfPlane{"circularity_um", "G_ccw_um", "G_cw_um",        "F_max_um",
                     "F_min_um",       "D_um",     "out_of_plane_um"};
const Names kOfStraightness{"straightness_um", "straightness_ls_um", "straightness_ends_um",
                            "range_um", "reversal_um"};
const Names kOfLength{"range_um"};
const Names kOfAngle{"range_urad", "reversal_urad"};
const Names kOfSquareness{"urad"};
const Names kOfMachine{"volumetric_um", "scale_ppm"};

struct Object {
  std::string name;
  std::string axes;  // those that it lies on
  const Names* quantities;
};

std::vector<Object> Objects() {
  std::vector<Object> objects;
  for (const char axis : std::string("XYZ")) {
    const std::string on(1, axis);
    objects.push_back({on, on, &kOfAxis});
    for (const char of : std::string("XYZ")) {
      objects.push_back(
          {fmt::format("E{}{}", of, axis), on, of == axis ? &kOfLength : &kOfStraightness});
    }
    for (const char of : std::string("ABC")) {
      objects.push_back({fmt::format("E{}{}", of, axis), on, &kOfAngle});
    }
  }
  for (const char* const plane : {"XY", "YZ", "ZX"}) objects.push_back({plane, plane, &kOfPlane});
  objects.push_back({"A0Z", "YZ", &kOfSquareness});
  objects.push_back({"B0Z", "ZX", &kOfSquareness});
  objects.push_back({"C0Y", "XY", &kOfSquareness});
  return objects;
}

// "positioning_A_um" -> "positioning_A_u95_um"; "urad" -> "u95_urad"
std::string StatedKey(const std::string& quantity) {
  const std::string stem(settings::StemOf(quantity));
  if (stem == quantity) return "u95_" + quantity;
  return stem + "_u95" + quantity.substr(stem.size());
}

void ReadQuantities(const settings::Table& table, const std::string& object,
                    const Names& quantities, Limits& limits) {
  for (const std::string& quantity : quantities) {
    // 0: none.
    const double size = table.Number(quantity, {.fallback = 0.0, .at_least = 0.0});
    const std::string stated_key = StatedKey(quantity);
    const double stated = table.Number(stated_key, {.fallback = 0.0, .at_least = 0.0});
    if (size > 0.0) limits.push_back({object, quantity, size, stated});
    if (stated > 0.0 && size == 0.0) {
      throw table.Error(stated_key, fmt::format("needs the limit {} beside it", quantity));
    }
  }
  table.RefuseUnknown();
}

Names QuantitiesOfAll() {
  Names all = kOfMachine;
  for (const Names* each : {&kOfPlane, &kOfAxis}) all.insert(all.end(), each->begin(), each->end());
  for (const char* const quantity : {"straightness_um", "range_urad"}) all.emplace_back(quantity);
  return all;
}

}  // namespace

Limits ReadLimits(const settings::Table& root) {
  Limits limits;
  const settings::Table table = root.Child("limits");
  const std::vector<Object> objects = Objects();
  Names names;
  names.reserve(objects.size());
  for (const Object& each : objects) names.push_back(each.name);
  const settings::Table axes = root.Child("axis");
  for (const settings::Table& of_object : table.Named()) {
    const auto object = std::ranges::find(objects, of_object.key(), &Object::name);
    if (object == objects.end()) {
      throw table.Error(of_object.key(),
                        fmt::format("there is no such error, axis or plane; did you mean \"{}\"?",
                                    settings::NearestWord(of_object.key(), names)));
    }
    for (const char axis : object->axes) {
      if (!root.Has("axis") || axes.Has(std::string(1, axis))) continue;
      throw table.Error(of_object.key(),
                        fmt::format("this machine has no axis {}; remove the limit", axis));
    }
    ReadQuantities(of_object, object->name, *object->quantities, limits);
  }
  ReadQuantities(table, "", QuantitiesOfAll(), limits);
  return limits;
}

Travels ReadTravels(const settings::Table& root) {
  Travels travels;
  for (const settings::Table& axis : root.Child("axis").Named()) {
    const auto travel = axis.Quantities("travel_mm", 2, std::vector<double>{});
    if (travel.size() != 2) continue;
    travels[axis.key().front()] = {travel[0] / settings::kMillimetre,
                                   travel[1] / settings::kMillimetre};
  }
  return travels;
}

}  // namespace abbe::history
