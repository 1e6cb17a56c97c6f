// What a cause happens to: an axis, a probe, a pivot, a sensor, or a thing known by name alone.
//
//   const Object object("X temp_table_c");
//   object.kind(), object.first(), object.sensor();      // kAxis, 0, "temp_table_c"
//
// Files, reports and results write its name; it is taken apart here and nowhere else:
//   "X", "XY"                     axes
//   "probe_a", "probe_a+probe_b"  probes of the head
//   "pivot_1", "link_1"           of a linkage, from its base on
//   "sensor_1"                    a gap sensor at a turning shaft
//   "cap", "head", "shaft" ...    what a machine has one of
// each with a blank and the name of a temperature sensor behind it, where one is meant.
// Units: none.
// Failure: none; a name of no such form is a thing known by name.
// Source: own names; docs/causes.md lists them.
// Validity: a name is enough to tell two objects apart.
#pragma once

#include <string>
#include <string_view>

namespace abbe::simulation {

class Object {
 public:
  enum class Kind : unsigned char {
    kAxis,
    kAxisPair,
    kProbe,
    kProbePair,
    kPivot,
    kLink,
    kSensor,
    kNamed
  };

  Object() = default;             // a thing without a name
  Object(std::string_view name);  // NOLINT: a name is an object
  Object(const std::string& name) : Object(std::string_view(name)) {}  // NOLINT
  Object(const char* name) : Object(std::string_view(name)) {}         // NOLINT

  const std::string& name() const { return name_; }
  // The name without the sensor, and the sensor; empty: none.
  std::string part() const { return name_.substr(0, part_size_); }
  std::string sensor() const { return sensor_; }

  Kind kind() const { return kind_; }
  // One or two.
  bool IsOfAxes() const { return kind_ == Kind::kAxis || kind_ == Kind::kAxisPair; }
  // From 0: X, probe_a, pivot_1 and so on; the second of a pair. 0 of what is known by name.
  int first() const { return first_; }
  int second() const { return second_; }

  friend bool operator==(const Object& a, const Object& b) { return a.name_ == b.name_; }

 private:
  std::string name_, sensor_;
  std::string::size_type part_size_ = 0;
  Kind kind_ = Kind::kNamed;
  int first_ = 0, second_ = 0;
};

// As a report writes it: "X (temp_table_c)".
std::string Title(const Object& object);

}  // namespace abbe::simulation
