#include "simulation/remembered_noise.h"

#include <memory>
#include <utility>

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The filter for some channels, the residuals of one instant beside each other.
class Whitener {
 public:
  Whitener(const VectorXd& times, Index channels, const estimation::NoiseMemory& noise)
      : filter_(times, noise), channels_(channels), weights_(filter_.Weights()) {}

  template <typename Columns>
  void Whiten(Columns& columns) const {
    EachChannel(columns, [&](MatrixXd& own) { filter_.Whiten(own); });
  }
  void Restore(MatrixXd& columns) const {
    EachChannel(columns, [&](MatrixXd& own) { filter_.Restore(own); });
  }
  void WhitenTransposed(MatrixXd& columns) const {
    EachChannel(columns, [&](MatrixXd& own) { filter_.WhitenTransposed(own); });
  }
  const VectorXd& weights() const { return weights_; }

 private:
  template <typename Columns, typename Filter>
  void EachChannel(Columns& columns, const Filter& filter) const {
    const Index instants = columns.rows() / channels_;
    for (Index channel = 0; channel < channels_; ++channel) {
      const auto rows = Eigen::seqN(channel, instants, channels_);
      MatrixXd own = columns(rows, Eigen::all);
      filter(own);
      columns(rows, Eigen::all) = own;
    }
  }

  estimation::MemoryFilter filter_;
  Index channels_;
  VectorXd weights_;
};

class RememberingResponse : public Response {
 public:
  RememberingResponse(std::shared_ptr<const Response> run, std::shared_ptr<const Whitener> noise)
      : run_(std::move(run)), noise_(std::move(noise)) {}

  MatrixXd Columns(const std::vector<Disturbance>& disturbances) const override {
    MatrixXd columns = run_->Columns(disturbances);
    noise_->Whiten(columns);
    return columns;
  }
  MatrixXd Readings(const VectorXd& left) const override {
    MatrixXd restored = left;
    noise_->Restore(restored);
    return run_->Readings(restored.col(0));
  }
  MatrixXd Tilts() const override { return run_->Tilts(); }
  MatrixXd BackToReadings(const MatrixXd& left) const override {
    MatrixXd back = left;
    noise_->WhitenTransposed(back);
    return run_->BackToReadings(back);
  }
  MatrixXd BackToStage(Index stage, const MatrixXd& back) const override {
    return run_->BackToStage(stage, back);
  }
  Eigen::RowVectorXd WeightsOf(Index stage) const override {
    return run_->WeightsOf(stage).cwiseProduct(noise_->weights().transpose());
  }
  bool RowsAreIndependent() const override { return false; }

 private:
  std::shared_ptr<const Response> run_;
  std::shared_ptr<const Whitener> noise_;
};

// `Base`: estimation::Residual or Responsive.
template <typename Base>
class Remembering : public Base {
 public:
  Remembering(std::shared_ptr<const Base> run, std::shared_ptr<const Whitener> noise)
      : run_(std::move(run)), noise_(std::move(noise)) {}

  Index Rows() const override { return run_->Rows(); }
  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    run_->Evaluate(x, values, jacobian);
    noise_->Whiten(values);
    if (jacobian != nullptr) noise_->Whiten(*jacobian);
  }

 protected:
  std::shared_ptr<const Base> run_;
  std::shared_ptr<const Whitener> noise_;
};

class RememberingRun : public Remembering<Responsive> {
 public:
  using Remembering::Remembering;
  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    return std::make_shared<RememberingResponse>(run_->At(x), noise_);
  }
};

std::shared_ptr<const Whitener> WhitenerOf(Index rows, const VectorXd& times,
                                           const estimation::NoiseMemory& noise) {
  return std::make_shared<const Whitener>(times, rows / times.size(), noise);
}

}  // namespace

SimulatedRun WithMemory(const SimulatedRun& run, const VectorXd& times,
                        const estimation::NoiseMemory& noise) {
  SimulatedRun remembers = run;
  const auto residual = std::make_shared<RememberingRun>(
      run.response, WhitenerOf(run.residual->Rows(), times, noise));
  remembers.residual = remembers.response = residual;
  return remembers;
}

std::shared_ptr<const estimation::Residual> WithMemory(
    std::shared_ptr<const estimation::Residual> residual, const VectorXd& times,
    const estimation::NoiseMemory& noise) {
  const Index rows = residual->Rows();
  return std::make_shared<Remembering<estimation::Residual>>(std::move(residual),
                                                             WhitenerOf(rows, times, noise));
}

std::vector<estimation::Stay> ChannelsOf(const VectorXd& left, const VectorXd& times) {
  const Index channels = left.size() / times.size();
  std::vector<estimation::Stay> each;
  for (Index channel = 0; channel < channels; ++channel) {
    each.push_back({times, left(Eigen::seqN(channel, times.size(), channels))});
  }
  return each;
}

}  // namespace abbe::simulation
