#include "simulation/sweep_simulation.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "estimation/dual_number.h"
#include "failure/failure.h"
#include "machine/volumetric_error.h"
#include "simulation/axes_in_travel.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using estimation::ParameterBlock;
using geometry::Transform;
using probes::kProbes;
using probes::kTopProbes;

constexpr double kTargetTilt = 1e-3;  // rad: how well a target is aligned before a sweep
constexpr std::array<const char*, kProbes> kLetters{"a", "b", "c", "d", "e"};
const estimation::PrintUnit kMicrometres{"um", 1e-6};
const estimation::PrintUnit kMicroradians{"urad", 1e-6};
const estimation::PrintUnit kRelative{"", 1.0};

bool OnTop(std::size_t probe) { return probe < kTopProbes; }

// What one reading of one probe depends on.
template <typename T>
struct Circumstances {
  geometry::ErrorVector<T> motions;         // of the swept axis
  Eigen::Vector3<T> squareness;             // [A0Z B0Z C0Y]
  Eigen::Vector2<T> place;                  // of the probe in the face: u and s or n, m
  T gain;                                   // what it shows = gain * gap
  Eigen::Vector3<T> turn, shift;            // installation of the head: about and along u, s, n
  Eigen::Vector3<T> tilt, face_squareness;  // of the target
};
constexpr int kLocal = 24;  // numbers in it, in this order

// The parts of a sweep that no parameter changes.
struct SweepPlan {
  machine::Chain chain;
  int axis;
  Eigen::Matrix3d R_MH;
  Vector3d head_T, corner_W;  // origin of H on the tool body, corner of the target, from the
                              // machine's reference point
  probes::Electrode electrode;
  probes::PerProbe<> height;  // m: of an electrode over its face
};

template <typename T>
Eigen::Matrix3<T> FaceTurn(int axis, const Eigen::Vector3<T>& squareness) {
  const T zero(0);
  if (axis == 0) return geometry::ExpRotation<T>({zero, squareness[1], squareness[2]});
  if (axis == 1) return geometry::ExpRotation<T>({squareness[0], zero, zero});
  return Eigen::Matrix3<T>::Identity();
}

// The outward normal of the face that looks along `nominal`, an axis direction of M.
template <typename T>
Eigen::Vector3<T> FaceNormal(const Vector3d& nominal, const Circumstances<T>& at) {
  Index axis = 0;
  nominal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Matrix3<T> R = geometry::ExpRotation<T>(at.tilt);
  return R * (FaceTurn<T>(static_cast<int>(axis), at.face_squareness) * nominal.cast<T>());
}

template <typename T>
Transform<T> ToolSeenFromWork(const SweepPlan& plan, const Vector3d& axes,
                              const Circumstances<T>& at) {
  machine::MotionErrors<T> errors;
  errors.axes[static_cast<std::size_t>(plan.axis)] = at.motions;
  errors.squareness = at.squareness;
  const std::string& from_work = plan.chain.workpiece_axes();
  const Eigen::Vector3<T> position = axes.cast<T>();
  const auto X_MW = machine::BodyPose<T>({from_work.rbegin(), from_work.rend()}, position, errors);
  const auto X_MT = machine::BodyPose<T>(plan.chain.tool_axes(), position, errors);
  return X_MW.Inverse() * X_MT;
}

double ValueOf(double value) { return value; }
template <typename T>
double ValueOf(const T& jet) {
  return jet.a;
}

template <typename T>
T ReadingOf(const SweepPlan& plan, std::size_t probe, const Transform<T>& X_WT,
            const Circumstances<T>& at) {
  const Eigen::Matrix3<T> R_MH = plan.R_MH.cast<T>();
  const Eigen::Matrix3<T> R = R_MH * geometry::RotationX(at.turn.x()) *
                              geometry::RotationY(at.turn.y()) * geometry::RotationZ(at.turn.z());
  const int normal = OnTop(probe) ? 2 : 1;
  const T height(plan.height[probe]);
  const Eigen::Vector3<T> in_head = OnTop(probe)
                                        ? Eigen::Vector3<T>(at.place[0], at.place[1], height)
                                        : Eigen::Vector3<T>(at.place[0], height, at.place[1]);
  Eigen::Vector3<T> shift = at.shift;
  shift[normal] = T(0);  // the zero takes it in: apart, the two could not be told
  const Eigen::Vector3<T> p_T = plan.head_T.cast<T>() + R * in_head + R_MH * shift;
  const Eigen::Vector3<T> w_W = X_WT.R * Eigen::Vector3<T>(-R.col(normal));
  const Eigen::Vector3<T> m = FaceNormal<T>(plan.R_MH.col(normal), at);
  const T gap = m.dot(plan.corner_W.cast<T>() - X_WT * p_T) / m.dot(w_W);
  if (plan.electrode.radius == 0.0 && plan.electrode.stray == 0.0) return at.gain * gap;
  // A tilt changes the reading in second order only: its own derivative is left out.
  const double cosine = std::min(1.0, std::abs(ValueOf(T(m.dot(w_W)))));
  return at.gain * probes::ElectrodeReading(plan.electrode, gap, std::acos(cosine));
}

template <typename T, typename Vector>
Circumstances<T> Unpack(const Vector& local) {
  return {local.template segment<6>(0),  local.template segment<3>(6),
          local.template segment<2>(9),  local[11],
          local.template segment<3>(12), local.template segment<3>(15),
          local.template segment<3>(18), local.template segment<3>(21)};
}

Vector3d TravelOf(const std::string& axes, const Vector3d& position) {
  Vector3d travel = Vector3d::Zero();
  for (const char axis : axes) travel[axis - 'X'] += position[axis - 'X'];
  return travel;
}

SweepPlan PlanOf(const machine::Chain& chain, const Vector3d& reference,
                 const probes::HeadSettings& head, const SweepRun& run) {
  const probes::AxisFrame& frame = head.Frame(run.axis);
  SweepPlan plan{chain,
                 machine::AxisIndex(run.axis),
                 frame.R_MH,
                 frame.p_MH - TravelOf(chain.tool_axes(), run.start) - reference,
                 frame.p_MH - TravelOf(chain.workpiece_axes(), run.start) - reference,
                 head.electrode,
                 {}};
  for (std::size_t i = 0; i < kProbes; ++i) plan.height[i] = head.probes[i].range / 2;
  return plan;
}

Eigen::Vector2d PlaceOf(const probes::HeadLayout<>& layout, std::size_t probe) {
  if (OnTop(probe)) return {layout.top[probe].u, layout.top[probe].s};
  return {layout.side[probe - kTopProbes].u, layout.side[probe - kTopProbes].n};
}

// cov of the readings of the probes of one face: noise of each, form of the face for all.
MatrixXd FaceCovariance(const SweepPlan& plan, const SweepInstrument& instrument,
                        const SweepRun& run, std::size_t first, std::size_t count) {
  const Index n = run.rows();
  const auto probes_of_face = static_cast<Index>(count);
  const bool target_moves = plan.chain.CarriesTarget(run.axis);
  const double sign = (target_moves ? -1.0 : 1.0) * plan.R_MH.col(0)[plan.axis];
  const double variance = instrument.target.form * instrument.target.form;
  const double length = instrument.target.form_length;
  MatrixXd V(n * probes_of_face, n * probes_of_face);
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t q = 0; q < count; ++q) {
      const Eigen::Vector2d apart =
          PlaceOf(instrument.head.layout, first + p) - PlaceOf(instrument.head.layout, first + q);
      auto block = V.block(static_cast<Index>(p) * n, static_cast<Index>(q) * n, n, n);
      for (Index h = 0; h < n; ++h) {
        for (Index g = 0; g < n; ++g) {
          const double along = apart[0] + sign * (run.position[g] - run.position[h]);
          const double square = along * along + apart[1] * apart[1];
          block(g, h) =
              variance == 0.0 ? 0.0 : variance * std::exp(-0.5 * square / (length * length));
        }
      }
      if (p == q) block += run.covariance[first + p];
    }
  }
  return V;
}

class SweepResidual : public estimation::Residual {
 public:
  SweepResidual(const machine::VolumetricModel& model, SweepPlan plan,
                const SweepInstrument& instrument, SweepRun run)
      : plan_(std::move(plan)), run_(std::move(run)), whiten_{} {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      functions_.push_back(model.Function(plan_.axis, motion));
      coefficients_ += functions_.back().size();
    }
    const std::array<std::size_t, 3> bounds{0, kTopProbes, kProbes};
    for (std::size_t face = 0; face < 2; ++face) {
      const std::size_t first = bounds[face], count = bounds[face + 1] - first;
      whiten_[face].compute(FaceCovariance(plan_, instrument, run_, first, count));
      if (whiten_[face].info() == Eigen::Success) continue;
      throw InputError(
          fmt::format("{}: the probes have no noise; state probe_nm in [noise] of the machine file",
                      run_.name));
    }
  }

  Index Rows() const override { return static_cast<Index>(kProbes) * run_.rows(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    if (jacobian != nullptr) jacobian->setZero();
    std::vector<machine::ErrorFunction> functions = functions_;
    Index at = 0;
    for (auto& function : functions) {
      function.SetCoefficients(x.segment(at, function.size()));
      at += function.size();
    }
    const VectorXd shared = x.tail(x.size() - coefficients_);
    for (Index row = 0; row < run_.rows(); ++row) {
      if (jacobian == nullptr) {
        Rows<double>(functions, shared, row, values, nullptr);
      } else {
        Rows<estimation::DualNumber<kLocal>>(functions, shared, row, values, jacobian);
      }
    }
    Whiten(values, jacobian);
  }

 private:
  // Where the numbers of Circumstances stand behind the coefficients in x, for one probe.
  static std::array<Index, kLocal> Places(std::size_t probe) {
    const auto i = static_cast<Index>(probe);
    std::array<Index, kLocal> places{};
    places.fill(-1);
    for (Index k = 0; k < 3; ++k) places[static_cast<std::size_t>(6 + k)] = k;  // squareness
    places[9] = 3 + 2 * i;
    places[10] = 4 + 2 * i;
    places[11] = 13 + i;
    for (Index k = 0; k < 12; ++k) places[static_cast<std::size_t>(12 + k)] = 18 + k;
    return places;
  }
  static constexpr Index kZero = 30;  // of the first probe

  template <typename T>
  void Rows(const std::vector<machine::ErrorFunction>& functions, const VectorXd& shared, Index row,
            VectorXd& values, estimation::RowMatrix* jacobian) const {
    constexpr bool kDual = !std::is_same_v<T, double>;
    VectorXd gradient(coefficients_);
    Eigen::Matrix<T, kLocal, 1> local;
    Index at = 0;
    for (std::size_t motion = 0; motion < functions.size(); ++motion) {
      local[static_cast<Index>(motion)] = T(functions[motion].Evaluate(
          run_.position[row], nullptr, jacobian == nullptr ? nullptr : gradient.data() + at));
      at += functions[motion].size();
    }
    for (Index k = 0; k < 3; ++k) local[6 + k] = T(shared[k]);
    if constexpr (kDual) {
      for (Index k = 0; k < 9; ++k) local[k].v[k] = 1.0;
    }
    for (Index k = 9; k < kLocal; ++k) local[k] = T(0);
    const auto X_WT = ToolSeenFromWork<T>(plan_, run_.AxesAt(row), Unpack<T>(local));
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      const auto places = Places(probe);
      for (std::size_t k = 9; k < kLocal; ++k) {
        const auto index = static_cast<Index>(k);
        local[index] = T(shared[places[k]]);
        if constexpr (kDual) local[index].v[index] = 1.0;
      }
      const T reading = ReadingOf<T>(plan_, probe, X_WT, Unpack<T>(local));
      const auto column = static_cast<Index>(probe);
      const Index out = column * run_.rows() + row;
      values[out] = run_.gap(column, row) - ValueOf(reading) - shared[kZero + column];
      if constexpr (kDual) AddDerivatives(functions, gradient, places, reading.v, out, jacobian);
      if (jacobian != nullptr) (*jacobian)(out, coefficients_ + kZero + column) = -1.0;
    }
  }

  template <typename Derivatives>
  void AddDerivatives(const std::vector<machine::ErrorFunction>& functions,
                      const VectorXd& gradient, const std::array<Index, kLocal>& places,
                      const Derivatives& by_local, Index out,
                      estimation::RowMatrix* jacobian) const {
    Index at = 0;
    for (std::size_t motion = 0; motion < functions.size(); ++motion) {
      const Index n = functions[motion].size();
      jacobian->row(out).segment(at, n) =
          -by_local[static_cast<Index>(motion)] * gradient.segment(at, n).transpose();
      at += n;
    }
    for (std::size_t k = 6; k < kLocal; ++k) {
      (*jacobian)(out, coefficients_ + places[k]) = -by_local[static_cast<Index>(k)];
    }
  }

  void Whiten(VectorXd& values, estimation::RowMatrix* jacobian) const {
    Index first = 0;
    for (const auto& factor : whiten_) {
      const Index n = factor.rows();
      factor.matrixL().solveInPlace(values.segment(first, n));
      if (jacobian != nullptr) {
        auto rows = jacobian->middleRows(first, n);
        factor.matrixL().solveInPlace(rows);
      }
      first += n;
    }
  }

  SweepPlan plan_;
  SweepRun run_;
  std::vector<machine::ErrorFunction> functions_;
  Index coefficients_ = 0;
  std::array<Eigen::LLT<MatrixXd>, 2> whiten_;
};

ParameterBlock BlockOf(const std::string& name, const estimation::PrintUnit& unit,
                       const std::vector<std::string>& entries, double prior_sd) {
  ParameterBlock block(name, unit, {});
  for (const std::string& entry : entries) {
    block.entries.push_back({.name = entry, .prior_sd = prior_sd, .held = prior_sd == 0.0});
    if (prior_sd == 0.0) block.entries.back().prior_sd = estimation::kNoPrior;
  }
  return block;
}

std::string Named(const std::string& what, const std::string& which) {
  return which.empty() ? what : what + " " + which;
}

std::vector<ParameterBlock> InstrumentBlocks(const SweepInstrument& instrument,
                                             const SweepRun& run) {
  const probes::HeadTolerance& tolerance = instrument.head.tolerance;
  std::vector<ParameterBlock> blocks;
  ParameterBlock position = BlockOf("probe_position", kMicrometres, {}, 0.0);
  ParameterBlock gain = BlockOf("probe_gain", kRelative, {}, 0.0);
  ParameterBlock zero = BlockOf("probe_zero " + run.name, kMicrometres, {}, 0.0);
  for (std::size_t i = 0; i < kProbes; ++i) {
    const std::string letter = kLetters[i];
    const Eigen::Vector2d place = PlaceOf(instrument.head.layout, i);
    for (int k = 0; k < 2; ++k) {
      const std::string across = OnTop(i) ? "_s" : "_n";
      position.entries.push_back({.name = letter + (k == 0 ? "_u" : across),
                                  .nominal = place[k],
                                  .prior_sd = tolerance.probe_position,
                                  .value = place[k]});
    }
    const double nominal = instrument.head.probes[i].gain;
    gain.entries.push_back(
        {.name = letter, .nominal = nominal, .prior_sd = tolerance.gain, .value = nominal});
    // A start from which the first step is small.
    zero.entries.push_back(
        {.name = letter,
         .value = run.gap.row(static_cast<Index>(i)).mean() - instrument.head.probes[i].range / 2});
  }
  for (ParameterBlock* block : {&position, &gain}) {
    for (auto& entry : block->entries) {
      entry.held = entry.prior_sd == 0.0;
      if (entry.held) entry.prior_sd = estimation::kNoPrior;
    }
  }
  const std::string axis(1, run.axis);
  const std::string& mounting = run.mounting;
  const std::string target = mounting.empty() ? run.name : mounting;
  blocks.push_back(std::move(position));
  blocks.push_back(std::move(gain));
  blocks.push_back(BlockOf(Named("head_turn " + axis, target), kMicroradians, {"u", "s", "n"},
                           tolerance.installation));
  blocks.push_back(BlockOf(Named("head_place " + axis, target), kMicrometres, {"u", "s", "n"},
                           tolerance.offset));
  blocks.push_back(
      BlockOf(Named("target_tilt", target), kMicroradians, {"a", "b", "c"}, kTargetTilt));
  ParameterBlock squareness = BlockOf("target_squareness", kMicroradians, {"YZ", "XZ", "XY"},
                                      instrument.target.u_squareness);
  for (auto& entry : squareness.entries) {
    entry.nominal = entry.value = instrument.target.squareness;
  }
  blocks.push_back(std::move(squareness));
  blocks.push_back(std::move(zero));
  return blocks;
}

}  // namespace

SimulatedRun SimulateSweep(const machine::VolumetricModel& model, const Vector3d& reference,
                           const SweepInstrument& instrument, const SweepRun& run) {
  SimulatedRun simulated{
      run.name, "sweep", {}, nullptr, estimation::RobustLoss::Huber(kPullsNoMore)};
  SweepRun within = run;
  Eigen::Matrix3Xd axes(3, run.rows());
  for (Index row = 0; row < run.rows(); ++row) axes.col(row) = run.AxesAt(row);
  within.position = AxesInTravel(model, axes, run.name, run.first_rows).row(run.axis - 'X');
  const SweepPlan plan = PlanOf(model.chain(), reference, instrument.head, run);
  const std::vector<ParameterBlock> machine_blocks = model.Blocks();
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    const std::string name = machine::MotionName(plan.axis, motion);
    for (const ParameterBlock& block : machine_blocks) {
      if (block.name == name) simulated.blocks.push_back(block);
    }
  }
  simulated.blocks.push_back(machine_blocks.back());
  for (ParameterBlock& block : InstrumentBlocks(instrument, run)) {
    simulated.blocks.push_back(std::move(block));
  }
  simulated.residual = std::make_shared<SweepResidual>(model, plan, instrument, within);
  return simulated;
}

}  // namespace abbe::simulation
