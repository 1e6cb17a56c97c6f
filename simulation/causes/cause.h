// A physical cause: something that the simulation leaves out, and what it would do to every run.
//
//   for (const Cause& cause : Causes())                                   // registry.h
//     for (const Object& object : cause.objects(scene))
//       columns = cause.columns(trace, object, shape);                    // one per coefficient
//
// A cause acts at one stage (simulation/disturbance.h) and is written once, for every kind of run
// that it touches. It is linear in its coefficients (a width, a gain, a sine and a cosine) and may
// have a shape besides (a period, a time constant, an order, an instant), which is searched over
// `shapes`. Where what it does is not quite in proportion to its size (a play, a delay), the shape
// is the size around which the column is taken, and none for a small one: Amount::kFollowsItsSize;
// of several coefficients after what is fixed (the ends of a travel).
// All coefficients are 0 when the cause is absent. Some causes are already parameters of the
// simulation, within a tolerance (squareness, the eccentricity of an encoder): these name the
// parameters that they set free in `relaxes` and have no columns. Keys: the names, units and signs
// by which files and reports know a cause; `tell` works them out of coefficients and shape,
// `recall` goes back.
// Frames: those of the stage at which it acts (simulation/disturbance.h).
// Units: SI inside; CauseKey::unit is what one unit of the key is in SI. A new cause is one file
// here and one line in registry.h. Shapes: a column is one Disturbance; one a coefficient.
// Failure: none; a cause that does not act on a run has no columns there.
// Source: docs/causes.md, and the comment of each cause's file.
// Validity: linear in the coefficients around SizeOf(shape); products of two causes are left out.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "simulation/causes/object.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// What the runs at hand consist of.
struct Scene {
  std::vector<const Trace*> traces;
  Eigen::Vector3d travel;    // m, lengths
  double form = 0.0;         // m: standard deviation of the form of the target that is stated
  double form_length = 0.0;  // m: correlation length of the form of the target; 0: not known
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // m: where the travels begin

  // A trace with a head.
  bool HasSweeps() const;
  // A linkage without a machine.
  bool HasArms() const;
  bool OnlyShafts() const;      // which say nothing of the axes
  Eigen::Index Pivots() const;  // 0 without a linkage
  // Names of the recorded temperatures, each once.
  std::vector<std::string> Sensors() const;
};

struct CauseKey {
  std::string name;  // "width_um"
  double unit;       // 1e-6
  // In the unit of the key: what is beyond is no such cause.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

struct CauseWords {
  std::string what;   // it is
  std::string shows;  // in the data
  std::string check;  // on the machine
  std::string remedy;
};

// What the columns and the search know of a cause.
struct Recalled {
  Eigen::VectorXd coefficients, shape;
};

// Where a cause sits decides who has to deal with it: an instrument is read without it; a motion
// that is no function of position is taken out before a map is made, which cannot hold it; what a
// map can hold stays there, to be compensated.
enum class CorrectedBy { kInstrument, kMotion, kMap };

// What a cause is a function of besides the readings themselves: positions, speeds and senses of
// axes and pivots, which a path of commands has; the time on a clock, whose zero is of no meaning
// to another path (a warm-up, the phase of a vibration); a recorded temperature.
enum class Follows : unsigned char { kPath, kTime, kTemperature };

// How what a cause does depends on its coefficients.
enum class Amount : unsigned char {
  kLinear,
  kFollowsItsSize,  // the shape ends with the coefficients around which the columns are taken
  kBinary,          // there or not: its one coefficient is 1
  // The coefficients are draws of a random function with the standard deviation shape[0] in each:
  // that is estimated, they are not what it is known by. Up to shape[1] it is as stated.
  kRandomField,
};

// A cause that is a wave over one variable of a trace. Its shape is its frequency (Hz), its period
// (m) or its order (waves per turn, whole); all between `least` and `most` are looked for.
struct Wave {
  enum class Shape : unsigned char { kFrequency, kPeriod, kOrder };
  using Over = std::function<Eigen::VectorXd(const Trace&, const Object&)>;

  Shape shape;
  double least, most;
  std::function<Eigen::Index(const Object&)> stage;
  Over over;  // s, m or rad, of each row; empty: does not act on this run

  // Waves per unit of the variable, and back.
  double WavesOf(double of_shape) const;
  // The inverse of WavesOf.
  double ShapeOf(double waves) const;
};

struct Cause {
  using Objects = std::function<std::vector<Object>(const Scene&)>;
  using Columns = std::function<std::vector<Disturbance>(const Trace&, const Object& object,
                                                         const Eigen::VectorXd& shape)>;
  using Shapes = std::function<std::vector<Eigen::VectorXd>(const Scene&)>;
  using ShapesOf = std::function<std::vector<Eigen::VectorXd>(const Scene&, const Object&)>;
  using Nearer = std::function<std::vector<Eigen::VectorXd>(const Scene&, const Eigen::VectorXd&)>;
  using ShapeSpread = std::function<double(const Scene&, const Eigen::VectorXd& shape)>;
  using Relaxes = std::function<std::vector<std::string>(const Object& object)>;
  using Tell = std::function<Eigen::VectorXd(const Eigen::VectorXd& coefficients,
                                             const Eigen::VectorXd& shape)>;
  using Recall = std::function<Recalled(const Eigen::VectorXd& values)>;

  std::string id;
  CauseWords words;
  std::vector<CauseKey> keys;
  Eigen::VectorXd plausible;  // standard deviation of each coefficient where the cause is present
  Objects objects;
  Columns columns = {};
  Shapes shapes = {};       // none: no shape
  ShapesOf shapes_of = {};  // where they depend on the object, in place of `shapes`
  Nearer nearer = {};  // those about one of the shapes, closer together; none: by halving the steps
  ShapeSpread shape_spread = {};  // u of a fixed shape that stands for all between two rows
  Relaxes relaxes = {};           // the parameters whose priors it relaxes; none: columns
  Tell tell = {};                 // none: the coefficients are the keys, then the shape
  Amount amount = Amount::kLinear;
  bool fixed_shapes = false;        // nothing between those tried
  bool one_event = false;           // cannot be held against other passes
  bool own_in_each_run = false;     // other runs tell its size alone
  bool always_there = false;        // of some size: beside others a nuisance parameter, even unseen
  bool exchanges_channels = false;  // of a pair: the noise of a channel goes with it
  Recall recall = {};               // of the values that `tell` gives; none: as without `tell`
  // Sine and cosine of shape[0] times the angle of a pivot: their phase is known no better than the
  // zero of its encoder.
  bool phase_follows_encoder_zero = false;
  bool in_map = false;                   // one of the 21 errors, a function of position
  std::optional<CorrectedBy> seat = {};  // none: as its object has it
  Follows follows = Follows::kPath;
  // Looked for beyond `shapes`, among all that the runs resolve.
  std::optional<Wave> wave = {};

  Eigen::Index coefficients() const { return plausible.size(); }
  // All that are tried; one without numbers where it has no shape.
  std::vector<Eigen::VectorXd> ShapesFor(const Scene& scene, const Object& object) const;
  // Its column depends on the size around which it is taken.
  bool FollowsItsSize() const { return amount == Amount::kFollowsItsSize; }
  // There or not.
  bool IsBinary() const { return amount == Amount::kBinary; }
  // Known by its standard deviation.
  bool IsRandomField() const { return amount == Amount::kRandomField; }
  // SI values in the order of the keys.
  Eigen::VectorXd ValuesOf(const Eigen::VectorXd& found, const Eigen::VectorXd& shape) const;
  // The way back.
  Recalled RecallFrom(const Eigen::VectorXd& values) const;
  // The key that is the shape: a frequency, a period, an instant, ...; none: no key is.
  std::optional<std::size_t> KeyOfShape() const;
  // Who deals with it at this object.
  CorrectedBy CorrectedAt(const Object& object) const;
};

// The objects that a scene offers: "X" ..., "XY" ..., "probe_a" ..., "pivot_1" ...
std::vector<Object> AxesOf(const Scene& scene);
// "XY", "XZ", "YZ"; none where all runs are of shafts.
std::vector<Object> AxisPairsOf(const Scene& scene);
// Where a sweep is among the runs.
std::vector<Object> ProbesOf(const Scene& scene);
// From the base on.
std::vector<Object> PivotsOf(const Scene& scene);
// The pivots, where an arm is among the runs.
std::vector<Object> JointsOfArms(const Scene& scene);
// "arm", where one is among the runs.
std::vector<Object> ArmOf(const Scene& scene);

// The stage of the positioning error of an axis: EXX, EYY, EZZ.
int Positioning(int axis);

// The size that the column is to be taken around; 0: a small one.
double SizeOf(const Eigen::VectorXd& shape);
// The shape of a cause that follows its size.
Eigen::VectorXd AroundSizes(const Eigen::VectorXd& fixed, const Eigen::VectorXd& sizes);

// A disturbance with one row that is not zero.
Disturbance InStage(const Trace& trace, Eigen::Index stage, const Eigen::RowVectorXd& values);

// The sine and the cosine of a phase in one stage, and their report as amplitude and phase.
std::vector<Disturbance> WaveInStage(const Trace& trace, Eigen::Index stage,
                                     const Eigen::RowVectorXd& phase);
// Sine and cosine of 2 pi frequency t, t of `clock`, in the mean of the readings of each row.
std::vector<Disturbance> LineInStage(const Trace& trace, Eigen::Index stage, double frequency,
                                     const Eigen::VectorXd& clock);
// s sin + c cos as a sin(. + phase), rad.
Eigen::Vector2d AmplitudeAndPhase(const Eigen::VectorXd& sine_cosine);
// The way back.
Eigen::Vector2d SineAndCosine(double amplitude, double phase);

// One shape for each number.
std::vector<Eigen::VectorXd> ShapesOf(const std::vector<double>& numbers);
// From first to last, each next one `ratio` times the one before.
std::vector<Eigen::VectorXd> GeometricShapes(double first, double last, double ratio);

}  // namespace abbe::simulation
