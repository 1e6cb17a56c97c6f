// The equations of head_inversion.h for many stations. Highway compiles what stands between
// HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each width of vectors, here by the compiler
// itself, and takes the widest that the processor has.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "probes/head_inversion.h"

#ifndef ABBE_PROBES_STATIONS
#define ABBE_PROBES_STATIONS
namespace abbe::probes {

struct Stations {
  Eigen::Index count;
  std::array<const double*, kProbes> readings;
  const double* d;
  std::array<double*, 6> errors;  // the last has EXX
};

}  // namespace abbe::probes
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probes/head_inversion_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::probes::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr double kLargest = std::numeric_limits<double>::max();

constexpr Eigen::Index kBlock = 64;  // stations: a block stays in the first-level cache
using Block = double[5][kBlock];

// For a few numbers; the compiler's own copy takes as long as the inversion.
HWY_INLINE void Copy(const double* from, Eigen::Index count, double* to) {
  const hn::ScalableTag<double> d;
  const auto lanes = static_cast<Eigen::Index>(hn::Lanes(d));
  Eigen::Index i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(hn::LoadU(d, from + i), d, to + i);
  }
  std::copy(from + i, from + count, to + i);
}

// Inverts stations from `first` on; whether one is refused.
template <typename Inversion>
[[gnu::flatten]] bool InvertBlock(const Inversion& invert, const Stations& stations,
                                  Eigen::Index first, Eigen::Index count) {
  const double *const r0 = stations.readings[0] + first, *const r1 = stations.readings[1] + first,
                      *const r2 = stations.readings[2] + first,
                      *const r3 = stations.readings[3] + first,
                      *const r4 = stations.readings[4] + first, *const d = stations.d + first,
                      *const exx = stations.errors[5] + first;
  Block errors;
  int refused = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const HeadErrors<> e = invert({r0[i], r1[i], r2[i], r3[i], r4[i]}, d[i], exx[i]);
    errors[0][i] = e.eax;
    errors[1][i] = e.ebx;
    errors[2][i] = e.ecx;
    errors[3][i] = e.eyx;
    errors[4][i] = e.ezx;
    // SmallAngleInversion::IsSmall without a branch.
    refused += std::abs(e.eax) + std::abs(e.ebx) + std::abs(e.ecx) < 1 ? 0 : 1;
    refused += std::abs(e.eyx + e.ezx) <= kLargest ? 0 : 1;
  }
  for (std::size_t k = 0; k < 5; ++k) Copy(errors[k], count, stations.errors[k] + first);
  return refused > 0;
}

// The inversion is a copy: nothing that a loop writes can change it.
template <typename Inversion>
bool InvertAll(const Inversion invert, const Stations& stations) {
  bool refused = false;
  for (Eigen::Index first = 0; first < stations.count; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, stations.count - first);
    if (InvertBlock(invert, stations, first, count)) refused = true;
  }
  return refused;
}

bool InvertTarget(const SmallAngleInversion& inversion, const Stations& stations) {
  return InvertAll([inversion](const PerProbe<>& readings, double d,
                               double exx) { return inversion.MovingTarget(readings, d, exx); },
                   stations);
}

bool InvertHead(const SimplifiedInversion& inversion, const Stations& stations) {
  return InvertAll([inversion](const PerProbe<>& readings, double d,
                               double exx) { return inversion(readings, d, exx); },
                   stations);
}

}  // namespace abbe::probes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::probes {

HWY_EXPORT(InvertTarget);
HWY_EXPORT(InvertHead);

void SmallAngleInversion::Invert(const Eigen::Ref<const Readings>& readings,
                                 const Eigen::Ref<const Eigen::VectorXd>& d,
                                 const Eigen::Ref<const Eigen::VectorXd>& exx,
                                 Errors& errors) const {
  const Eigen::Index n = readings.rows();
  if (d.size() != n || (exx.size() != 0 && exx.size() != n)) {
    throw InputError(fmt::format("{} rows of readings with {} of travel and {} of EXX", n, d.size(),
                                 exx.size()));
  }
  errors.resize(n, Eigen::NoChange);
  if (exx.size() == 0) {
    errors.col(5).setZero();
  } else {
    errors.col(5) = exx;
  }
  Stations stations{.count = n, .readings = {}, .d = d.data(), .errors = {}};
  for (std::size_t i = 0; i < kProbes; ++i) stations.readings[i] = readings.col(i).data();
  for (std::size_t i = 0; i < 6; ++i) stations.errors[i] = errors.col(i).data();
  const bool refused = moving_ == MovingBody::kTarget
                           ? HWY_DYNAMIC_DISPATCH(InvertTarget)(*this, stations)
                           : HWY_DYNAMIC_DISPATCH(InvertHead)(linear_, stations);
  if (refused) RefuseFirst(readings, d, errors);
}

}  // namespace abbe::probes
#endif  // HWY_ONCE
