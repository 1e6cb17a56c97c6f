// How far a long computation is, for its caller.
//
//   const ProgressTo caller([](std::size_t done, std::size_t total, const std::string& what) {});
//   Steps steps(2);                  // in the computation
//   steps.Begin("fit of all runs");  // 0 of 2
//   steps.Begin("what is left");     // 1 of 2
//
// A step may have steps of its own; these add to the total, which so grows while more is found to do.
// Steps that turn out to be needless count as done where their Steps end. Without a ProgressTo on the
// thread of the caller nothing happens.
// Units: steps, which do not take the same time. Shapes: done at most total.
// Failure: what the called function throws; it ends the computation and reaches the caller, as any
// exception that is not a NumericalError.
// Validity: of the thread that made the ProgressTo alone; workers say nothing.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace abbe {

class ProgressTo {
 public:
  using Function =
      std::function<void(std::size_t done, std::size_t total, const std::string& what)>;

  explicit ProgressTo(Function tell) : tell_(std::move(tell)), before_(current_) {
    current_ = this;
  }
  ~ProgressTo() { current_ = before_; }
  ProgressTo(const ProgressTo&) = delete;
  ProgressTo& operator=(const ProgressTo&) = delete;

  // Says that all is done.
  void End() const { tell_(total_, total_, "done"); }

 private:
  friend class Steps;
  Function tell_;
  ProgressTo* before_;
  std::size_t done_ = 0, total_ = 0;
  inline static thread_local ProgressTo* current_ = nullptr;
};

class Steps {
 public:
  explicit Steps(std::size_t count) : to_(ProgressTo::current_), left_(count) {
    if (to_ != nullptr) to_->total_ += count;
  }
  ~Steps() {
    if (to_ != nullptr) to_->done_ += left_;
  }
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  // The step before it is done. One more than there are adds one.
  void Begin(const std::string& what) {
    if (to_ == nullptr) return;
    if (begun_ && left_ > 0) Done();
    if (left_ == 0) Add();
    begun_ = true;
    to_->tell_(to_->done_, to_->total_, what);
  }

 private:
  void Done() {
    --left_;
    ++to_->done_;
  }
  void Add() {
    ++left_;
    ++to_->total_;
  }

  ProgressTo* const to_;
  std::size_t left_;  // that are not done
  bool begun_ = false;
};

}  // namespace abbe
