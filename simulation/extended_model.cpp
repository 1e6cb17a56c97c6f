#include "simulation/extended_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "failure/failure.h"
#include "recording/instant.h"
#include "settings/document.h"
#include "settings/nearest_word.h"
#include "settings/toml_text.h"
#include "settings/unit.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using settings::Float;
using settings::Quoted;
using settings::Table;

constexpr std::int64_t kFormat = 1;

// All objects of a machine that has this sensor.
std::vector<Object> ObjectsOf(const Cause& cause, const CauseObjects& machine,
                              const std::string& sensor) {
  Trace head, linkage, shaft;
  if (machine.head) head.head.emplace();
  linkage.linkage.emplace().angles.resize(machine.pivots, 1);
  shaft.rim.emplace().sensors = kMostRimSensors;  // a machine file says nothing of shafts
  if (!sensor.empty()) head.sensors = {sensor};
  auto objects = cause.objects({{&head, &linkage, &shaft}, Eigen::Vector3d::Ones()});
  if (!objects.empty() || machine.pivots == 0) return objects;
  // Nor does it say whether a machine carries the linkage, and what of an arm was recorded.
  linkage.linkage->is_arm = true;
  linkage.linkage->behind.setZero(machine.pivots, 1);
  return cause.objects({{&linkage}, Eigen::Vector3d::Ones()});
}

// Causes share an id where what they do differs from object to object.
std::vector<const Cause*> CausesNamed(const Table& table) {
  const std::string id = table.Text("id");
  std::vector<const Cause*> causes;
  std::vector<std::string> known;
  for (const Cause& cause : Causes()) {
    known.push_back(cause.id);
    if (cause.id == id) causes.push_back(&cause);
  }
  if (!causes.empty()) return causes;
  throw table.Error("id", fmt::format("no cause \"{}\" is known; the nearest is \"{}\"", id,
                                      settings::NearestWord(id, known)));
}

ModelledCause FindCause(const Table& table, const CauseObjects& machine) {
  const auto causes = CausesNamed(table);
  const std::string object = table.Text("object"), sensor = table.Text("sensor", "");
  const std::string full = sensor.empty() ? object : fmt::format("{} {}", object, sensor);
  std::vector<std::string> offered;
  for (const Cause* cause : causes) {
    for (const Object& each : ObjectsOf(*cause, machine, sensor)) {
      if (each == full) return {cause, full, {}, {}, {}};
      offered.push_back(each.part());
    }
  }
  if (offered.empty()) {
    throw table.Error("object",
                      sensor.empty() && !ObjectsOf(*causes.front(), machine, "temp_c").empty()
                          ? std::string("needs a sensor; add for example sensor = \"temp_table_c\"")
                          : fmt::format("machine \"{}\" has nothing that {} could happen to; "
                                        "delete the table",
                                        machine.machine, causes.front()->id));
  }
  throw table.Error("object", fmt::format("machine \"{}\" has no {} that {} could happen to; the "
                                          "nearest is \"{}\"",
                                          machine.machine, Quoted(full), causes.front()->id,
                                          settings::NearestWord(object, offered)));
}

void ReadCovariance(const Table& table, ModelledCause& cause) {
  if (!table.Has("covariance")) return;
  const Index n = cause.cause->coefficients();
  const auto numbers = table.Quantities("covariance", n * n);
  cause.covariance = Eigen::Map<const Eigen::MatrixXd>(numbers.data(), n, n);
}

ModelledCause ReadCause(const Table& table, const CauseObjects& machine) {
  ModelledCause cause = FindCause(table, machine);
  const auto& keys = cause.cause->keys;
  cause.values.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    cause.values[i] = keys[i].unit * table.Number(keys[i].name, {.at_least = keys[i].least,
                                                                 .at_most = keys[i].most});
  }
  if (table.Has("u95")) {
    const Table u95 = table.Child("u95");
    cause.u95.resize(cause.values.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      cause.u95[i] = keys[i].unit * u95.Number(keys[i].name, {.fallback = 0.0, .at_least = 0.0});
    }
    u95.RefuseUnknown();
  }
  ReadCovariance(table, cause);
  cause.probability =
      table.Number("probability", {.fallback = 1.0, .at_least = 0.0, .at_most = 1.0});
  cause.rivals = table.Texts("rivals", 0, std::vector<std::string>{});
  table.RefuseUnknown();
  return cause;
}

void RefuseOtherObject(const Table& table, const CauseObjects& machine, const Object& object) {
  using Kind = Object::Kind;
  const bool lacks = object.kind() == Kind::kPivot   ? object.first() >= machine.pivots
                     : object.kind() == Kind::kProbe ? !machine.head
                                                     : false;
  if (!lacks) return;
  throw table.Error("object", fmt::format("machine \"{}\" has no {}; delete the table",
                                          machine.machine, object.name()));
}

Origin ReadOrigin(const Table& root) {
  Origin origin;
  if (root.Has("started")) {
    const auto seconds = recording::SecondsOf(root.Text("started"));
    if (!seconds) throw root.Error("started", "is no time; write it as 2026-11-21T09:00:00Z");
    origin.started = *seconds;
  }
  for (const Table& start : root.Children("start")) {
    origin.temperature[start.Text("sensor")] = start.Quantity("temperature_c");
    start.RefuseUnknown();
  }
  return origin;
}

ModelGain ReadGain(const Table& root) {
  const Table table = root.Child("gain");
  const settings::NumberRule rule{.fallback = 0.0, .at_least = 0.0};
  ModelGain gain;
  gain.heldout_rows = table.Integer("heldout_rows", rule);
  gain.heldout_before = table.Number("heldout_rms_before", rule);
  gain.heldout_after = table.Number("heldout_rms_after", rule);
  gain.fitted_before = table.Number("fitted_rms_before", rule);
  gain.fitted_after = table.Number("fitted_rms_after", rule);
  table.RefuseUnknown();
  return gain;
}

void ReadDiagnosis(const Table& root, ExtendedModel& model) {
  if (!root.Has("diagnosis")) return;
  const Table table = root.Child("diagnosis");
  model.verdict = table.Choice(
      "verdict", {"clean", "explained", "ambiguous", kVerdictLearned, kVerdictUnexplained}, true);
  model.next_runs = table.Texts("next_runs", 0, std::vector<std::string>{});
  for (const Table& left : table.Children("unexplained")) {
    Unexplained& one = model.unexplained.emplace_back();
    one.object = left.Text("object");
    one.variable = left.Text("variable");
    one.amplitude = left.Number("amplitude", {.at_least = 0.0});
    one.unit = left.Text("unit");
    if (left.Has("in_space_um")) one.in_space = left.Quantity("in_space_um", {.at_least = 0.0});
    left.RefuseUnknown();
  }
  table.RefuseUnknown();
}

std::string DiagnosisText(const ExtendedModel& model) {
  if (model.verdict.empty()) return "";
  std::string text = fmt::format("\n[diagnosis]\nverdict = {}\n", Quoted(model.verdict));
  if (!model.next_runs.empty()) {
    text += fmt::format("next_runs = {}\n", settings::QuotedList(model.next_runs));
  }
  for (const Unexplained& one : model.unexplained) {
    text += fmt::format(
        "\n# no known cause explains this\n[[diagnosis.unexplained]]\nobject = {}\nvariable = "
        "{}\namplitude = {}\nunit = {}\n",
        Quoted(one.object), Quoted(one.variable), Float(one.amplitude), Quoted(one.unit));
    if (one.in_space)
      text += fmt::format("in_space_um = {}\n", Float(*one.in_space / settings::kMicro));
  }
  return text;
}

std::string CauseText(const ModelledCause& cause) {
  std::string text =
      fmt::format("\n# {}\n[[cause]]\nid = {}\nobject = {}\n", cause.cause->words.what,
                  Quoted(cause.cause->id), Quoted(cause.object.part()));
  if (const std::string sensor = cause.object.sensor(); !sensor.empty()) {
    text += fmt::format("sensor = {}\n", Quoted(sensor));
  }
  std::string u95;
  for (std::size_t i = 0; i < cause.cause->keys.size(); ++i) {
    const auto& key = cause.cause->keys[i];
    text += fmt::format("{} = {}\n", key.name, Float(cause.values[i] / key.unit));
    if (cause.u95.size() == 0) continue;
    u95 +=
        fmt::format("{}{} = {}", u95.empty() ? "" : ", ", key.name, Float(cause.u95[i] / key.unit));
  }
  text += fmt::format("probability = {}\n", Float(cause.probability));
  if (!cause.rivals.empty()) {
    text += fmt::format("rivals = {}\n", settings::QuotedList(cause.rivals));
  }
  if (!u95.empty()) text += fmt::format("u95 = {{ {} }}\n", u95);
  if (cause.covariance.size() > 0) {
    const Eigen::MatrixXd& C = cause.covariance;
    text += fmt::format("covariance = {}\n",
                        settings::Floats({C.data(), static_cast<std::size_t>(C.size())}));
  }
  return text;
}

}  // namespace

ModelledCause ModelledTerm(LearnedTerm term) {
  const auto learned = LearnedCause::Of(std::move(term));
  const LearnedTerm& of = learned->term();
  return {.cause = &learned->cause(),
          .object = learned->object(),
          .values = of.coefficients,
          .u95 = {},
          .covariance = of.covariance,
          .learned = learned};
}

std::string ModelledCause::Name() const { return fmt::format("{}:{}", cause->id, Title(object)); }

ExtendedModel ReadExtendedModel(const std::filesystem::path& path, const CauseObjects& objects) {
  const auto document = settings::Document::Read(path);
  const Table root = document.Root();
  if (!root.Has("extended_model")) {
    throw root.Error("",
                     "is no extended model, which begins with extended_model = 1; abbe "
                     "diagnose -o writes one");
  }
  if (root.Integer("extended_model") != kFormat) {
    throw root.Error("extended_model", "is of another version of abbe; diagnose again");
  }
  ExtendedModel model;
  model.machine = root.Text("machine");
  if (model.machine != objects.machine) {
    throw root.Error("machine", fmt::format("the model is of machine \"{}\", this one is \"{}\"; "
                                            "give the model of this machine or diagnose it",
                                            model.machine, objects.machine));
  }
  model.origin = ReadOrigin(root);
  ReadDiagnosis(root, model);
  model.gain = ReadGain(root);
  for (const Table& source : root.Children("data")) {
    model.sources.push_back({source.Text("file"), source.Text("sha256", "")});
    source.RefuseUnknown();
  }
  for (const Table& table : root.Children("cause")) {
    model.causes.push_back(ReadCause(table, objects));
  }
  for (const Table& table : root.Children("learned")) {
    model.causes.push_back(ModelledTerm(ReadLearnedTerm(table)));
    RefuseOtherObject(table, objects, model.causes.back().object);
  }
  root.RefuseUnknown();
  return model;
}

std::string ExtendedModelText(const ExtendedModel& model) {
  std::string text = fmt::format(
      "# What the simulation of this machine lacked, found by abbe diagnose. Give it to other\n"
      "# commands by --causes; to remove a cause delete its table. Keys: docs/extended-model.md.\n"
      "extended_model = {}\nmachine = {}\n",
      kFormat, Quoted(model.machine));
  if (model.origin.started != 0.0) {
    text += fmt::format("started = {}\n", Quoted(recording::InstantText(model.origin.started)));
  }
  text += DiagnosisText(model);
  for (const ModelledCause& cause : model.causes) {
    text += cause.learned ? LearnedTermText(cause.learned->term()) : CauseText(cause);
  }
  const ModelGain& gain = model.gain;
  text += "\n# Measured less simulated, in units of the stated noise.\n[gain]\n";
  text += fmt::format("fitted_rms_before = {}\nfitted_rms_after = {}\n", Float(gain.fitted_before),
                      Float(gain.fitted_after));
  if (gain.heldout_rows > 0) {
    text += fmt::format("heldout_rows = {}\nheldout_rms_before = {}\nheldout_rms_after = {}\n",
                        gain.heldout_rows, Float(gain.heldout_before), Float(gain.heldout_after));
  }
  for (const auto& [sensor, temperature] : model.origin.temperature) {
    text += fmt::format("\n[[start]]\nsensor = {}\ntemperature_c = {}\n", Quoted(sensor),
                        Float(temperature));
  }
  for (const ModelSource& source : model.sources) {
    text += fmt::format("\n[[data]]\nfile = {}\nsha256 = {}\n", Quoted(source.file),
                        Quoted(source.sha256));
  }
  return text;
}

}  // namespace abbe::simulation
