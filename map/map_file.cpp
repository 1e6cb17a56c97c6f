#include "map/map_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "machine/form_of_shape.h"
#include "map/text_file.h"
#include "recording/instant.h"
#include "settings/document.h"
#include "settings/toml_text.h"

namespace abbe::map {
namespace {

using Eigen::Index;
using machine::FormShape;
using settings::Float;
using settings::Floats;
using settings::Quoted;
using settings::QuotedList;
using settings::Table;

constexpr std::int64_t kFormat = 1;
constexpr std::array kTravelKeys{"x", "y", "z"};

std::array<double, 8> SizesOf(const machine::Population& p) {
  return {p.positioning, p.straightness, p.roll,  p.pitch,
          p.yaw,         p.squareness,   p.scale, p.smoothness};
}

std::string HeadText(const ErrorMap& map) {
  const MapOrigin& origin = map.origin();
  const auto of_squareness = [&](int i) { return std::string(origin.SourceOf(kErrors - 3 + i)); };
  std::string text = fmt::format(
      "# An error map: docs/map.md says what each key means.\nformat = {}\nmachine = {}\n"
      "chain = {}\npositive = {}\nreference = {}\ntool = {}\ntemperature_c = {}\nscale = "
      "{}\nsquareness = {}\n"
      "squareness_from = {}\n\n[travel]\n",
      kFormat, Quoted(origin.machine), Quoted(map.model().chain().Text()),
      Quoted(map.model().chain().PositiveText()), Floats(origin.reference),
      Floats(Eigen::Vector3d(origin.tool.array() + 0.0)),  // no -0
      Float(origin.temperature), Quoted(map.Scale()), Floats(map.model().squareness()),
      QuotedList(std::array{of_squareness(0), of_squareness(1), of_squareness(2)}));
  for (std::size_t axis = 0; axis < kTravelKeys.size(); ++axis) {
    const machine::Travel& travel = map.model().travels()[axis];
    if (!(travel.last > travel.first)) continue;  // no such axis
    text +=
        fmt::format("{} = {}\n", kTravelKeys[axis], Floats(std::array{travel.first, travel.last}));
  }
  if (!origin.limits) return text;
  text += "\n[limit]\n";
  for (std::size_t axis = 0; axis < kTravelKeys.size(); ++axis) {
    const machine::Travel& limit = (*origin.limits)[axis];
    if (!(limit.last > limit.first)) continue;
    text +=
        fmt::format("{} = {}\n", kTravelKeys[axis], Floats(std::array{limit.first, limit.last}));
  }
  return text;
}

std::string FunctionText(const std::string& name, std::string_view source,
                         const machine::ErrorFunction& function) {
  std::string text = fmt::format("\n[[error]]\nname = \"{}\"\nfrom = \"{}\"\nform = {}\n", name,
                                 source, Quoted(function.form()->Name()));
  for (const auto& [key, numbers] : function.form()->Shape()) {
    text += fmt::format("{} = {}\n", key, Floats(numbers));
  }
  if (function.gauge() == machine::Gauge::kNone) text += "gauge = \"none\"\n";
  return text + fmt::format("coefficients = {}\n", Floats(function.coefficients()));
}

std::string CovarianceText(const ErrorMap& map) {
  std::string text =
      fmt::format("\n[covariance]\nnames = {}\nrows = [\n", QuotedList(map.ParameterNames()));
  for (Index i = 0; i < map.cov_pp().rows(); ++i) {
    for (Index j = 0; j <= i; ++j) text += Float(map.cov_pp()(i, j)) + ", ";
    text.back() = '\n';
  }
  return text + "]\n";
}

std::string StateText(const MapState& state, Index parameters) {
  std::string text =
      fmt::format("\n[state]\ntime = {}\n", Quoted(recording::InstantText(state.time)));
  if (state.walk) text += fmt::format("walk = {}\n", Floats(SizesOf(*state.walk)));
  text += fmt::format("names = {}\nvalues = {}\nrows = [\n", QuotedList(state.names),
                      Floats(state.values));
  for (Index i = parameters; i < state.covariance.rows(); ++i) {
    for (Index j = 0; j <= i; ++j) text += Float(state.covariance(i, j)) + ", ";
    text.back() = '\n';
  }
  text += "]\n";
  for (const Warmth& each : state.sensors) {
    text += fmt::format(
        "\n[[state.sensor]]\nname = {}\nlag_s = {}\ntemperature_c = {}\nlagged_c = {}\n",
        Quoted(each.sensor), Float(each.lag), Float(each.temperature), Float(each.lagged));
  }
  return text;
}

Eigen::Vector3d Vector(const Table& table, const char* key) {
  return Eigen::Vector3d(table.Quantities(key, 3).data());
}

// A kind of run is one word; which kinds there are, the maps of other versions may know better.
std::string SourceNamed(const Table& table, const char* key, const std::string& name) {
  const auto of_a_word = [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; };
  if (name == kPriorOnly) return {};
  if (!name.empty() && std::all_of(name.begin(), name.end(), of_a_word)) return name;
  throw table.Error(key, fmt::format("\"{}\" is not a source; write prior, or the kind of run that "
                                     "determined it, for example sweep or linkage",
                                     name));
}

MapOrigin ReadOrigin(const Table& root) {
  MapOrigin origin;
  origin.machine = root.Text("machine");
  origin.reference = Vector(root, "reference");
  origin.tool = Vector(root, "tool");
  origin.temperature = root.Quantity("temperature_c");
  origin.scale_is_calibrated =
      root.Choice("scale", {"prior only", "calibrated"}, true) == "calibrated";
  const auto names = root.Texts("squareness_from", 3);
  for (std::size_t i = 0; i < 3; ++i) {
    origin.sources[kErrors - 3 + i] = SourceNamed(root, "squareness_from", names[i]);
  }
  return origin;
}

// The result of `make`; its InputError gets the place in the file.
template <typename Make>
auto AtKey(const Table& table, const char* key, const Make& make) {
  try {
    return make();
  } catch (const InputError& failure) {
    throw table.Error(key, failure.what());
  }
}

std::array<machine::Travel, machine::kAxes> ReadTravels(const Table& table,
                                                        const machine::Chain& chain) {
  std::array<machine::Travel, machine::kAxes> travels{};
  for (std::size_t axis = 0; axis < kTravelKeys.size(); ++axis) {
    if (chain.Text().find("XYZ"[axis]) == std::string::npos) continue;
    const auto ends = table.Quantities(kTravelKeys[axis], 2);
    if (!(ends[0] < ends[1])) {
      throw table.Error(kTravelKeys[axis], "must be [first, last] with the first below the last");
    }
    travels[axis] = {ends[0], ends[1]};
  }
  table.RefuseUnknown();
  return travels;
}

machine::VolumetricModel ReadFrame(const Table& root) {
  machine::Chain chain =
      AtKey(root, "chain", [&] { return machine::Chain::Parse(root.Text("chain")); });
  AtKey(root, "positive", [&] {
    chain.ReadPositive(root.Text("positive", ""), "write positive = \"...\" of X, Y and Z");
    return 0;
  });
  return {chain, ReadTravels(root.Child("travel"), chain)};
}

void ReadFunction(const Table& table, machine::VolumetricModel& model, MapOrigin& origin,
                  std::array<bool, kErrors>& seen) {
  const std::string name = table.Text("name");
  const int error = ErrorNamed(name);
  if (error < 0 || error >= kErrors - 3)
    throw table.Error("name", "is not an error motion; write EXX ... ECZ");
  if (std::exchange(seen[error], true)) {
    throw table.Error("name", name + " is given twice");
  }
  origin.sources[error] = SourceNamed(table, "from", table.Text("from"));
  const int axis = error / machine::kMotions, motion = error % machine::kMotions;
  const std::string form = table.Text("form");
  FormShape shape;
  for (const std::string& key : AtKey(table, "form", [&] { return machine::ShapeNames(form); })) {
    shape[key] = table.Quantities(key, 0);
  }
  const auto made = AtKey(table, "form", [&] { return machine::FormOf(form, shape); });
  // Checked before memory is allocated for the size in the shape.
  const auto c = table.Quantities("coefficients", made->size());
  const bool bare = table.Choice("gauge", {"zero at start", "none"}) == "none";
  const auto gauge = bare ? machine::Gauge::kNone : machine::Gauge::kZeroAtStart;
  AtKey(table, "form", [&] { return model.SetForm(axis, motion, made, gauge); });
  model.SetCoefficients(axis, motion, Eigen::Map<const Eigen::VectorXd>(c.data(), c.size()));
  table.RefuseUnknown();
}

Eigen::MatrixXd ReadCovariance(const Table& table, const std::vector<std::string>& names) {
  if (table.Texts("names", 0) != names) {
    throw table.Error("names", "are not the parameters of this map; write the map anew");
  }
  const Index n = names.size();
  const auto rows = table.Quantities("rows", n * (n + 1) / 2);
  Eigen::MatrixXd cov(n, n);
  std::size_t at = 0;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j <= i; ++j) cov(i, j) = cov(j, i) = rows[at++];
  }
  table.RefuseUnknown();
  return cov;
}

// `cov_pp`: the part of it that is the map's.
MapState ReadState(const Table& table, const Eigen::MatrixXd& cov_pp) {
  MapState state;
  const auto time = recording::SecondsOf(table.Text("time"));
  if (!time) throw table.Error("time", "is no instant; write it like 2026-11-21T09:00:00Z");
  state.time = *time;
  if (table.Has("walk")) {
    const auto w = table.Quantities("walk", 8);
    if (!(*std::min_element(w.begin(), w.end()) >= 0.0) || !(w[7] > 0.0)) {
      throw table.Error("walk", "holds a size below 0, or a length that is not above it");
    }
    state.walk = {w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7]};
  }
  state.names = table.Texts("names", 0);
  const Index before = cov_pp.rows(), n = state.names.size();
  const auto values = table.Quantities("values", 0);
  if (std::ssize(values) != n) throw table.Error("values", "must be one for each name");
  state.values = Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  const auto rows = table.Quantities("rows", 0);
  if (std::ssize(rows) != n * before + n * (n + 1) / 2) {
    throw table.Error("rows", "are not those of the names below the covariance of the map");
  }
  state.covariance.resize(before + n, before + n);
  state.covariance.topLeftCorner(before, before) = cov_pp;
  std::size_t at = 0;
  for (Index i = before; i < before + n; ++i) {
    for (Index j = 0; j <= i; ++j) state.covariance(i, j) = state.covariance(j, i) = rows[at++];
  }
  for (const Table& sensor : table.Children("sensor")) {
    state.sensors.push_back({sensor.Text("name"), sensor.Number("lag_s", {.at_least = 0.0}),
                             sensor.Number("temperature_c"), sensor.Number("lagged_c")});
    sensor.RefuseUnknown();
  }
  table.RefuseUnknown();
  return state;
}

}  // namespace

void WriteMap(const ErrorMap& map, const std::filesystem::path& path) {
  std::string text = HeadText(map);
  for (int error = 0; error < kErrors - 3; ++error) {
    const auto& function =
        map.model().Function(error / machine::kMotions, error % machine::kMotions);
    if (function.form() == nullptr) continue;
    text += FunctionText(ErrorName(error), map.origin().SourceOf(error), function);
  }
  if (map.StatesUncertainty()) text += CovarianceText(map);
  if (map.state()) text += StateText(*map.state(), map.cov_pp().rows());
  WriteWhole(text, path);
}

ErrorMap ReadMap(const std::filesystem::path& path) {
  const auto document = settings::Document::Read(path);
  const Table root = document.Root();
  if (root.Integer("format") != kFormat) {
    throw root.Error("format", "is of another version of abbe; fuse the runs again");
  }
  MapOrigin origin = ReadOrigin(root);
  machine::VolumetricModel model = ReadFrame(root);
  if (root.Has("limit")) origin.limits = ReadTravels(root.Child("limit"), model.chain());
  model.SetSquareness(Vector(root, "squareness"));
  std::array<bool, kErrors> seen{};
  for (const Table& table : root.Children("error")) ReadFunction(table, model, origin, seen);
  Eigen::MatrixXd cov;
  if (root.Has("covariance")) {
    const ErrorMap bare(origin, model, {});
    cov = ReadCovariance(root.Child("covariance"), bare.ParameterNames());
  }
  std::optional<MapState> state;
  if (root.Has("state")) {
    if (cov.size() == 0) throw root.Error("state", "needs [covariance]; fuse the runs again");
    state = ReadState(root.Child("state"), cov);
  }
  root.RefuseUnknown();
  if (!state) return {std::move(origin), std::move(model), std::move(cov)};
  return AtKey(root, "state", [&] {
    return ErrorMap(std::move(origin), std::move(model), std::move(cov), std::move(state));
  });
}

}  // namespace abbe::map
