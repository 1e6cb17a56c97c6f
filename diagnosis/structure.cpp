#include "diagnosis/structure.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "diagnosis/variables.h"
#include "simulation/causes/shaft.h"

namespace abbe::diagnosis {

using Eigen::Index;
using Eigen::RowVectorXd;
using simulation::Disturbance;
using simulation::Scene;
using simulation::Trace;

namespace {

const estimation::PrintUnit kMicrometres{"um", 1e-6}, kMicroradians{"urad", 1e-6};

}  // namespace

Instrument InstrumentOf(const Trace& trace) {
  if (trace.rim) return kRim;
  return trace.head ? kProbes : kLinkage;
}

bool StageChannel::IsPlausible(double amount) const {
  constexpr double kMost = 1e-3;  // m
  return unit.name != kMicrometres.name || amount < kMost;
}

std::vector<StageChannel> ChannelsOf(const Scene& scene) {
  std::vector<StageChannel> channels;
  const auto add = [&](const std::vector<simulation::Object>& objects, auto stage_of,
                       const auto& unit, unsigned instruments) {
    for (const simulation::Object& each : objects) {
      channels.push_back({each.name(), stage_of(each.first()), unit, instruments});
    }
  };
  const auto reading = [](int index) { return simulation::kReadingStage + index; };
  const auto encoder = [](int index) { return simulation::kEncoderStage + index; };
  add(simulation::ProbesOf(scene), reading, kMicrometres, kProbes);
  add(simulation::PivotsOf(scene), encoder, kMicroradians, kLinkage);
  if (scene.travel.isZero(0.0)) return channels;
  add(simulation::AxesOf(scene), simulation::Positioning, kMicrometres, kProbes | kLinkage);
  add(simulation::RimSensorsOf(scene), reading, kMicrometres, kRim);
  return channels;
}

std::optional<Range> RangeOf(const std::string& variable, const StageChannel& channel,
                             const Scene& scene) {
  Range range;
  for (const Trace* trace : scene.traces) {
    if (!channel.Feels(*trace)) continue;
    const RowVectorXd values = ValuesOf(variable, *trace);
    if (values.size() == 0) continue;
    range.first = std::min(range.first, values.minCoeff());
    range.last = std::max(range.last, values.maxCoeff());
  }
  if (!(range.last > range.first)) return {};
  return range;
}

Eigen::ArrayXd Range::Scaled(const RowVectorXd& values) const {
  return 2.0 * (values.transpose().array() - first) / Length() - 1.0;
}

Factors FactorsOf(const std::string& product) {
  const auto star = product.find('*');
  return {product.substr(0, star), product.substr(star + 1)};
}

Index Structure::columns() const {
  return form == Form::kLine ? 2 : form == Form::kInterval ? 1 : form == Form::kProduct ? 4 : terms;
}

Eigen::VectorXd Structure::Weights() const {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(columns());
  if (is_rough) weights.array() /= Eigen::ArrayXd::LinSpaced(columns(), 1.0, columns());
  return weights;
}

bool Structure::IsOfItself() const {
  std::string object = channel.object;
  std::ranges::transform(object, object.begin(), [](unsigned char c) { return std::tolower(c); });
  return variable.substr(variable.rfind(' ') + 1) == object;
}

double Structure::among() const {
  return form == Form::kLine ? kLines : form == Form::kInterval ? kIntervals : 1.0;
}

std::vector<Disturbance> Structure::ColumnsOf(const Trace& trace) const {
  if (form == Form::kProduct) return ProductsOf(trace);
  const RowVectorXd values = ValuesOf(variable, trace);
  if (!channel.Feels(trace) || values.size() == 0) {
    return std::vector(columns(), simulation::NoDisturbance(trace));
  }
  if (form == Form::kLine) {
    return simulation::WaveInStage(trace, channel.stage, wave * values);
  }
  if (form == Form::kInterval) {
    const auto within = values.array() >= interval.from && values.array() < interval.to;
    return {simulation::InStage(trace, channel.stage, within.cast<double>())};
  }
  const RowVectorXd factor = FactorOf(variable, trace);
  const Index first = factor.size() > 0 && !IsOfItself() ? 0 : 1;
  const Eigen::VectorXd weights = Weights();
  std::vector<Disturbance> columns;
  for (Index k = first; k < first + terms; ++k) {
    const double turn = std::numbers::pi * k / range.Length();
    RowVectorXd term = (turn * (values.array() - range.first)).cos();
    if (factor.size() > 0) term = term.cwiseProduct(factor);
    columns.push_back(simulation::InStage(trace, channel.stage, weights[k - first] * term));
  }
  return columns;
}

std::vector<Disturbance> Structure::ProductsOf(const Trace& trace) const {
  const auto [one, other] = FactorsOf(variable);
  const RowVectorXd values = ValuesOf(one, trace), others = ValuesOf(other, trace);
  std::vector<Disturbance> columns(4, simulation::NoDisturbance(trace));
  if (!channel.Feels(trace) || values.size() == 0 || others.size() == 0) return columns;
  const auto legendre = [](const Eigen::ArrayXd& v) {
    return std::array<Eigen::ArrayXd, 2>{v, 1.5 * v.square() - 0.5};
  };
  const auto first = legendre(range.Scaled(values)), last = legendre(second.Scaled(others));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns[i].row(channel.stage) = (first[i / 2] * last[i % 2]).transpose();
  }
  return columns;
}

}  // namespace abbe::diagnosis
