#include "machine/tanh_network.h"

#include <fmt/format.h>

#include <cmath>

#include "failure/failure.h"

namespace abbe::machine {
namespace {

class TanhNetwork : public FunctionForm {
 public:
  TanhNetwork(int neurons, double gain, NetworkBias bias)
      : neurons_(neurons), gain_(gain), has_bias_(bias == NetworkBias::kWithBias) {}

  std::string Name() const override { return has_bias_ ? "network with bias" : "network"; }
  int size() const override { return has_bias_ ? 3 * neurons_ + 1 : 2 * neurons_; }
  FormShape Shape() const override {
    return {{"neurons", {static_cast<double>(neurons_)}}, {"gain_per_m", {gain_}}};
  }
  bool IsLinear() const override { return false; }

  double Evaluate(double x, const double* c, double* slope, double* gradient) const override {
    const int stride = has_bias_ ? 3 : 2;
    double value = has_bias_ ? c[size() - 1] : 0.0, rise = 0.0;
    for (int q = 0; q < neurons_; ++q) {
      const double* neuron = c + stride * q;
      const double v = neuron[0], b = has_bias_ ? neuron[1] : 0.0, w = neuron[stride - 1];
      const double y = std::tanh(gain_ * v * x + b);
      const double bend = w * (1.0 - y * y);  // d value / d input of the neuron
      value += w * y;
      rise += bend * gain_ * v;
      if (gradient == nullptr) continue;
      double* out = gradient + stride * q;
      out[0] = bend * gain_ * x;
      if (has_bias_) out[1] = bend;
      out[stride - 1] = y;
    }
    if (gradient != nullptr && has_bias_) gradient[size() - 1] = 1.0;
    if (slope != nullptr) *slope = rise;
    return value;
  }

  std::vector<double> Pieces(double a, double b) const override {
    constexpr int kPieces = 64;
    std::vector<double> pieces;
    for (int i = 0; i <= kPieces; ++i) pieces.push_back(a + (b - a) * i / kPieces);
    return pieces;
  }

 private:
  int neurons_;
  double gain_;
  bool has_bias_;
};

}  // namespace

SharedForm MakeTanhNetwork(int neurons, double gain, NetworkBias bias) {
  if (neurons < 1)
    throw InputError(fmt::format("a network of {} neurons: give 1 or more", neurons));
  if (!(gain > 0.0))
    throw InputError(fmt::format("a network with the gain {}: give more than 0", gain));
  return std::make_shared<TanhNetwork>(neurons, gain, bias);
}

}  // namespace abbe::machine
