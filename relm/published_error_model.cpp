// The twelve geometric errors of Boelens (2006), and its bearing roundness.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "relm/error_models.h"
#include "relm/model_builder.h"

namespace abbe::relm {
namespace {

using Eigen::Vector3d;

constexpr double kAcrossFrom = 0.5;  // least sine between an axis and a segment across it

// A segment in B at encoder zero.
struct PlacedSegment {
  Vector3d start;
  Vector3d direction;
  int encoder = -1;  // number of the pivot whose encoder it carries
};

std::vector<PlacedSegment> Place(const std::vector<Segment>& segments) {
  std::vector<PlacedSegment> placed;
  geometry::Transform<double> X;
  int encoders = 0;
  for (const Segment& segment : segments) {
    const Vector3d start = X.p;
    X.R = X.R * geometry::RotationZ(segment.theta) * geometry::RotationY(segment.phi);
    X.p += X.R.col(2) * segment.length;
    const bool encoder = segment.encoder != SegmentEncoder::kNone;
    placed.push_back({start, X.R.col(2), encoder ? encoders++ : -1});
  }
  return placed;
}

bool StandsAcross(const PlacedSegment& segment, const JointAxis& axis) {
  return segment.direction.cross(axis.direction).norm() > kAcrossFrom;
}

// The segment about which the next pivot is twisted: the longest one across the axis of the pivot
// before, from that pivot's segment on. -1: there is none.
int TwistedSegment(const std::vector<Segment>& segments, const std::vector<PlacedSegment>& placed,
                   int from, int to, const JointAxis& axis) {
  int longest = -1;
  for (int q = from; q < to; ++q) {
    if (!StandsAcross(placed[q], axis)) continue;
    if (longest < 0 || segments[q].length > segments[longest].length) longest = q;
  }
  return longest;
}

struct Motions {
  int tilt_x, tilt_y;
  std::vector<int> pivots;  // the joints' turns
  std::vector<int> twists;  // per pivot but the last: about the segment before the next; -1: none
  std::vector<int> links;   // per segment
};

Motions AddMotions(const LinkageSettings& settings, const std::vector<PlacedSegment>& placed,
                   MotionChain& chain) {
  const auto count = static_cast<int>(placed.size());
  std::vector<int> twist_after(placed.size(), -1);  // per segment: number of the twist
  Motions motions{};
  int last = -1;
  for (int q = 0; q < count; ++q) {
    if (placed[q].encoder < 0) continue;
    if (last >= 0) {
      const JointAxis& axis = settings.chain.axes()[placed[last].encoder];
      const int segment = TwistedSegment(settings.segments, placed, last, q, axis);
      if (segment >= 0) twist_after[segment] = placed[last].encoder;
    }
    last = q;
  }
  motions.twists.assign(settings.chain.joints(), -1);
  motions.tilt_x = chain.Turn(Vector3d::Zero(), Vector3d::UnitX());
  motions.tilt_y = chain.Turn(Vector3d::Zero(), Vector3d::UnitY());
  for (int q = 0; q < count; ++q) {
    if (placed[q].encoder >= 0) motions.pivots.push_back(chain.Joint(placed[q].encoder));
    motions.links.push_back(chain.Shift(placed[q].direction));
    if (twist_after[q] >= 0) {
      const Vector3d end = placed[q].start + placed[q].direction * settings.segments[q].length;
      motions.twists[twist_after[q]] = chain.Turn(end, placed[q].direction);
    }
  }
  return motions;
}

// A segment of zero length represents an offset, and the effect at the end of a link of tilts that
// the model lacks.
double OffsetDeviation(const LinkageSettings& settings) {
  double longest = 0.0;
  for (const Segment& segment : settings.segments) longest = std::max(longest, segment.length);
  return std::hypot(settings.tolerance.pivot_offset, settings.tolerance.pivot_angle * longest);
}

void AddGeometry(const LinkageSettings& settings, const Motions& motions, ModelBuilder& model) {
  const LinkageTolerance& sd = settings.tolerance;
  const double offset = OffsetDeviation(settings);
  model.Block("link", kMillimetres);
  for (std::size_t q = 1; q < settings.segments.size(); ++q) {
    const double length = settings.segments[q].length;
    model.Entry(fmt::format("segment_{}", q), length > 0 ? sd.link : offset,
                {.motion = motions.links[q]}, length, length);
  }
  model.Block("tilt", kMicroradians);
  model.Entry("head_x", sd.pivot_angle, {.motion = motions.tilt_x});
  model.Entry("head_y", sd.pivot_angle, {.motion = motions.tilt_y});
  model.Block("radial_angle", kMicroradians);
  for (std::size_t i = 0; i < motions.pivots.size(); ++i) {
    model.Entry(PivotName(i), sd.encoder_offset, {.motion = motions.pivots[i]});
    if (motions.twists[i] < 0) continue;
    model.Entry(PivotName(i + 1) + "_twist", sd.pivot_angle, {.motion = motions.twists[i]});
  }
}

// The run-out of a pivot lengthens the first segment after it that lies across its axis.
void AddBearing(const LinkageSettings& settings, const std::vector<PlacedSegment>& placed,
                const Motions& motions, ModelBuilder& model) {
  model.Block("bearing", kMicrometres);
  for (std::size_t q = 0; q < placed.size(); ++q) {
    const int joint = placed[q].encoder;
    if (joint < 0) continue;
    std::size_t link = q;
    while (link < placed.size() && !StandsAcross(placed[link], settings.chain.axes()[joint]))
      ++link;
    if (link == placed.size()) continue;
    model.HarmonicEntries(PivotName(joint), settings.tolerance.bearing, motions.links[link], joint,
                          settings.bearing_harmonics);
  }
}

}  // namespace

LinkageModel PublishedErrorModel(const LinkageSettings& settings, bool with_bearing) {
  if (settings.segments.empty()) {
    throw InputError(
        "linkage: the published error model needs form = \"pivots\" or \"segments\"; use the "
        "complete model");
  }
  const auto placed = Place(settings.segments);
  ModelBuilder model(settings);
  const Motions motions = AddMotions(settings, placed, model.motions);
  AddGeometry(settings, motions, model);
  if (with_bearing) AddBearing(settings, placed, motions, model);
  return model.Build(
      ErrorModelName(with_bearing ? ErrorModel::kPublishedWithBearing : ErrorModel::kPublished));
}

}  // namespace abbe::relm
