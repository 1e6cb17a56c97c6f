// Sweeps with the probe head and their squareness.
#include <limits>

#include "history/result_reader.h"

namespace abbe::history {
namespace {

// The instrument behind each entry of a sweep's budget (docs/sweep.md); its noise is its own.
const std::map<std::string, std::string> kInstrumentOf{{"gain", "head"},
                                                       {"linearity", "head"},
                                                       {"position", "head"},
                                                       {"installation", "mounting"},
                                                       {"form", "target"}};

// One standard uncertainty, or the mean square of one a station, as variance.
double Variance(const Json& u) {
  if (u.is_number()) return u.get<double>() * u.get<double>();
  double sum = 0.0;
  for (const Json& each : u) sum += each.get<double>() * each.get<double>();
  return u.empty() ? 0.0 : sum / static_cast<double>(u.size());
}

Shares SharesOf(const Json& budget) {
  double total = 0.0;
  Shares shares;
  for (const auto& [source, u] : budget.items()) {
    const double variance = Variance(u);
    total += variance;
    const auto instrument = kInstrumentOf.find(source);
    if (instrument != kInstrumentOf.end()) shares[instrument->second] += variance;
  }
  if (!(total > 0.0)) return {};
  for (auto& [instrument, share] : shares) share /= total;
  return shares;
}

}  // namespace

std::optional<Stations> StationsOf(const Json& result) {
  const std::vector<double> at = ListAt(result, "stations", kToMillimetre);
  const std::string axis = TextAt(result, "axis");
  if (TextAt(result, "kind") != "sweep" || at.empty() || axis.empty()) return std::nullopt;
  const Json& planned = ObjectAt(result, "planned");
  const auto count = [&](const char* key) {
    return static_cast<int>(NumberAt(planned, key).value_or(0.0));
  };
  return Stations{axis.front(), at.front(), at.back(), count("stations"),
                  count("missing_stations")};
}

void ReadSweep(const Json& result, Extract& extract) {
  const std::vector<double> stations = ListAt(result, "stations", kToMillimetre);
  const std::optional<Stations> along = StationsOf(result);
  for (const auto& entry : ObjectAt(result, "errors").items()) {
    const std::string& name = entry.key();
    const Json& error = entry.value();
    const std::string unit = ShownUnit(TextAt(error, "unit"));
    const double coverage = NumberAt(error, "coverage").value_or(standards::kCoverage);
    const Shares shares = SharesOf(ObjectAt(ObjectAt(result, "budget"), name));
    const auto add = [&](const std::string& quantity, std::optional<double> value,
                         std::optional<double> u) {
      if (!value) return;
      if (u) u = kToMicro * *u;
      extract.figures.push_back(
          {name, quantity + "_" + unit, "", kToMicro * *value, u, coverage, shares, along});
    };
    const Json& straightness = ObjectAt(ObjectAt(result, "straightness"), name);
    const auto u = NumberAt(straightness, "u");
    add("straightness", NumberAt(straightness, "minimum_zone"), u);
    add("straightness_ls", NumberAt(straightness, "least_squares"), u);
    add("straightness_ends", NumberAt(straightness, "end_points"), u);
    const Json& range = ObjectAt(ObjectAt(result, "angular_ranges"), name);
    add("range", NumberAt(range, "value"), NumberAt(range, "u"));
    const Json& reversal = ObjectAt(ObjectAt(ObjectAt(result, "reversal"), name), "mean");
    add("reversal", NumberAt(reversal, "value"), NumberAt(reversal, "u"));
    Curve curve{name,
                unit,
                "sweep",
                stations,
                ListAt(error, "value", kToMicro),
                ListAt(error, "u", kToMicro),
                coverage,
                shares};
    if (curve.value.size() == stations.size() && !stations.empty()) {
      extract.curves.push_back(std::move(curve));
    }
  }
}

void ReadSquareness(const Json& result, Extract& extract) {
  const auto value = NumberAt(result, "value"), u = NumberAt(result, "u");
  if (!value) return;
  Shares shares;
  if (const auto target = NumberAt(result, "u_target"); target && u && *u > 0.0) {
    shares["target"] = (*target / *u) * (*target / *u);
  }
  extract.figures.push_back({TextAt(result, "name"), "urad", "sweeps", kToMicro * *value,
                             u ? std::optional(kToMicro * *u) : std::nullopt, standards::kCoverage,
                             shares});
}

}  // namespace abbe::history
