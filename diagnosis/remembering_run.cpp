#include "diagnosis/remembering_run.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Response;
using simulation::Responsive;

class RememberingResidual : public KnownRows {
 public:
  RememberingResidual(std::shared_ptr<const estimation::Residual> residual,
                      std::shared_ptr<const Responsive> response)
      : residual_(std::move(residual)), response_(std::move(response)) {}

  Index Rows() const override { return residual_->Rows(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    const std::scoped_lock lock(mutex_);
    if (jacobian == nullptr) {
      values = ValuesAt(x);
      return;
    }
    const State& state = StateFor(x);
    values = ValuesAt(x);
    *jacobian = state.known->jacobian;
  }

  std::shared_ptr<const Derivatives> KnownAt(const VectorXd& x) const override {
    const std::scoped_lock lock(mutex_);
    State& state = StateFor(x);
    if (state.known->square.size() == 0) {
      const auto& J = state.known->jacobian;
      state.known->square = MatrixXd::Zero(J.cols(), J.cols());
      state.known->square.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
      state.known->square.triangularView<Eigen::StrictlyUpper>() =
          state.known->square.transpose().triangularView<Eigen::StrictlyUpper>();
    }
    return state.known;
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    const std::scoped_lock lock(mutex_);
    State& state = StateFor(x);
    if (!state.response) state.response = response_->At(state.x);
    return state.response;
  }

 private:
  struct State {
    VectorXd x, values;
    std::shared_ptr<Derivatives> known;
    std::shared_ptr<const Response> response = nullptr;
  };

  const VectorXd& ValuesAt(const VectorXd& x) const {
    if (last_x_.size() != x.size() || last_x_ != x) {
      VectorXd values(Rows());
      residual_->Evaluate(x, values, nullptr);
      last_x_ = x;
      last_values_ = std::move(values);
    }
    return last_values_;
  }

  State& StateFor(const VectorXd& x) const {
    constexpr double kLinear = 0.03;
    constexpr std::size_t kPlaces = 2;
    const VectorXd values = ValuesAt(x);
    for (State& state : states_) {
      const VectorXd off = values - state.values - state.known->jacobian * (x - state.x);
      if (off.norm() < kLinear) return state;
    }
    State state{x, VectorXd(Rows()), std::make_shared<Derivatives>()};
    estimation::RowMatrix jacobian(Rows(), x.size());
    residual_->Evaluate(x, state.values, &jacobian);
    state.known->jacobian = jacobian;
    if (states_.size() == kPlaces) states_.pop_back();
    states_.push_front(std::move(state));
    return states_.front();
  }

  const std::shared_ptr<const estimation::Residual> residual_;
  const std::shared_ptr<const Responsive> response_;
  mutable std::mutex mutex_;
  mutable VectorXd last_x_, last_values_;
  mutable std::deque<State> states_;  // the newest first
};

}  // namespace

simulation::SimulatedRun Remembering(simulation::SimulatedRun run) {
  const auto remembering = std::make_shared<const RememberingResidual>(run.residual, run.response);
  run.residual = remembering;
  if (run.response) run.response = remembering;
  if (const auto exchanged = run.noise_exchanged) {
    struct Known {
      std::mutex mutex;
      std::map<std::pair<std::size_t, std::size_t>, simulation::SimulatedRun> runs;
    };
    run.noise_exchanged = [exchanged, known = std::make_shared<Known>()](std::size_t one,
                                                                         std::size_t other) {
      const std::scoped_lock lock(known->mutex);
      const auto [at, is_new] = known->runs.try_emplace({one, other});
      if (is_new) at->second = Remembering(exchanged(one, other));
      return at->second;
    };
  }
  return run;
}

}  // namespace abbe::diagnosis
