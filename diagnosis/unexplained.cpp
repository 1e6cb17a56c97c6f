#include "diagnosis/unexplained.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "diagnosis/variables.h"
#include "simulation/causes/cause.h"
#include "simulation/causes/shaft.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using simulation::Disturbance;
using simulation::Scene;
using simulation::Trace;

constexpr Index kTerms = 8;
constexpr double kAbsorbed = 1e-4;  // of the most information: what is left is rounding
constexpr Index kLines = 400;
constexpr double kOfAWave = 0.4;  // over the range, from one line to the next

const estimation::PrintUnit kMicrometres{"um", 1e-6}, kMicroradians{"urad", 1e-6};

// The instruments that runs are recorded with.
enum Instrument : unsigned { kProbes = 1, kLinkage = 2, kRim = 4 };

Instrument InstrumentOf(const Trace& trace) {
  if (trace.rim.sensors > 0) return kRim;
  return trace.gap.size() > 0 ? kProbes : kLinkage;
}

struct Channel {
  std::string object;
  Index stage;
  estimation::PrintUnit unit;
  unsigned instruments;  // whose runs feel it
};

std::vector<Channel> ChannelsOf(const Scene& scene) {
  std::vector<Channel> channels;
  for (const std::string& probe : simulation::ProbesOf(scene)) {
    channels.push_back(
        {probe, simulation::kReadingStage + simulation::ProbeOf(probe), kMicrometres, kProbes});
  }
  for (const std::string& pivot : simulation::PivotsOf(scene)) {
    channels.push_back(
        {pivot, simulation::kEncoderStage + simulation::PivotOf(pivot), kMicroradians, kLinkage});
  }
  if (scene.travel.isZero(0.0)) return channels;
  for (const std::string& axis : simulation::AxesOf(scene)) {
    channels.push_back({axis, simulation::Positioning(simulation::AxisOf(axis[0])), kMicrometres,
                        kProbes | kLinkage});
  }
  for (const std::string& sensor : simulation::RimSensorsOf(scene)) {
    channels.push_back(
        {sensor, simulation::kReadingStage + simulation::RimSensorOf(sensor), kMicrometres, kRim});
  }
  return channels;
}

bool Feels(const Channel& channel, const Trace& trace) {
  return (channel.instruments & InstrumentOf(trace)) != 0;
}

struct Range {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();
};

Range RangeOf(const std::string& variable, const Channel& channel, const Scene& scene) {
  Range range;
  for (const Trace* trace : scene.traces) {
    if (!Feels(channel, *trace)) continue;
    const RowVectorXd values = ValuesOf(variable, *trace);
    if (values.size() == 0) continue;
    range.first = std::min(range.first, values.minCoeff());
    range.last = std::max(range.last, values.maxCoeff());
  }
  return range;
}

struct Answer {
  double chi_square = 0.0;
  int freedom = 0;
  double amplitude = 0.0;
  double lines = 1.0;  // among which this is the strongest
  double period = 0.0;

  // Natural logarithm of the probability of as much by chance.
  double LogProbability() const {
    if (freedom == 0) return 0.0;
    const boost::math::chi_squared distribution(freedom);
    const double one = boost::math::cdf(boost::math::complement(distribution, chi_square));
    const double log_one = one > 0.0 ? std::log(one) : -0.5 * chi_square;
    return std::min(0.0, log_one + std::log(lines));
  }
};

// What the projected columns explain.
Answer Explained(const Fit::Projection& projection) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(projection.information);
  const double most = eigen.eigenvalues().maxCoeff();
  Answer answer;
  VectorXd found = VectorXd::Zero(projection.score.size());
  for (Index i = 0; i < found.size(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * most) || value <= 0.0) continue;
    const double along = eigen.eigenvectors().col(i).dot(projection.score);
    answer.chi_square += along * along / value;
    found += along / value * eigen.eigenvectors().col(i);
    ++answer.freedom;
  }
  answer.amplitude = found.norm() / std::numbers::sqrt2;
  return answer;
}

class Questions {
 public:
  explicit Questions(const Fit& fit)
      : fit_(fit),
        scene_(fit.campaign().scene()),
        channels_(ChannelsOf(scene_)),
        lines_(channels_.size()) {}

  std::vector<Leftover> AskAll() {
    for (const std::string& variable : PeriodicVariablesOf(scene_)) FindLines(variable);
    for (std::size_t channel = 0; channel < channels_.size(); ++channel) Ask(channel);
    std::sort(found_.begin(), found_.end(),
              [](const Found& a, const Found& b) { return a.log_probability < b.log_probability; });
    std::vector<Leftover> leftovers;
    for (Found& each : found_) {
      const auto same = [&](const Leftover& other) { return other.object == each.leftover.object; };
      if (std::any_of(leftovers.begin(), leftovers.end(), same)) continue;
      each.leftover.p_value =
          std::min(1.0, std::exp(each.log_probability) * static_cast<double>(found_.size()));
      if (each.leftover.p_value < kDoubt) leftovers.push_back(std::move(each.leftover));
    }
    return leftovers;
  }

 private:
  // kTerms cosines of a variable over its range, or a line of it.
  struct Question {
    std::string variable;
    Range range;
    double wave = 0.0;  // of the line

    Index columns() const { return wave > 0.0 ? 2 : kTerms; }
  };
  struct Found {
    Leftover leftover;
    double log_probability;
  };

  void Note(const Channel& channel, const std::string& variable, const Answer& answer) {
    found_.push_back(
        {{variable, channel.object, answer.amplitude, channel.unit, 1.0, answer.period},
         answer.LogProbability()});
  }

  static std::vector<Disturbance> ColumnsOf(const Question& question, const Channel& channel,
                                            const Trace& trace) {
    const RowVectorXd values = ValuesOf(question.variable, trace);
    if (values.size() == 0) {
      return std::vector(static_cast<std::size_t>(question.columns()),
                         simulation::NoDisturbance(trace));
    }
    if (question.wave > 0.0) {
      return simulation::WaveInStage(trace, channel.stage, question.wave * values);
    }
    std::vector<Disturbance> columns;
    const double length = question.range.last - question.range.first;
    for (Index term = 1; term <= kTerms; ++term) {
      const double waves = std::numbers::pi * static_cast<double>(term) / length;
      columns.push_back(simulation::InStage(
          trace, channel.stage, (waves * (values.array() - question.range.first)).cos()));
    }
    return columns;
  }

  // All questions of a channel together: they share its stage.
  void Ask(std::size_t which) {
    const Channel& channel = channels_[which];
    std::vector<Question> questions = lines_[which];
    for (const std::string& variable : VariablesOf(scene_)) {
      const Range range = RangeOf(variable, channel, scene_);
      if (range.last > range.first) questions.push_back({variable, range});
    }
    std::vector<Index> groups;
    groups.reserve(questions.size());
    for (const Question& question : questions) groups.push_back(question.columns());
    const auto disturb = [&](const Trace& trace) {
      std::vector<Disturbance> columns;
      if (!Feels(channel, trace)) return columns;
      for (const Question& question : questions) {
        for (auto& column : ColumnsOf(question, channel, trace))
          columns.push_back(std::move(column));
      }
      return columns;
    };
    const auto projections = fit_.Project(disturb, groups);
    for (std::size_t q = 0; q < questions.size(); ++q) {
      Answer answer = Explained(projections[q]);
      if (questions[q].wave > 0.0) {
        answer.lines = static_cast<double>(kLines);
        answer.period = 2.0 * std::numbers::pi / questions[q].wave;
      }
      if (channel.instruments == kRim) answer.amplitude = RmsOf(answer, channel);
      Note(channel, questions[q].variable, answer);
    }
  }

  // Of what is explained, over the rows. Where a shaft turns evenly, time and the harmonics that
  // are known go together, and the coefficients of the answer are larger than what they do.
  double RmsOf(const Answer& answer, const Channel& channel) const {
    double weight = 0.0;
    for (std::size_t run = 0; run < fit_.runs(); ++run) {
      if (InstrumentOf(fit_.TraceOf(run)) != kRim) continue;
      weight += fit_.ScoresOf(run, channel.stage).weights.sum();
    }
    return std::sqrt(answer.chi_square / weight);
  }

  // The lines of each channel are weighed with the largest information that they could have; the
  // strongest is then asked as it should be. Channels of one kind of run share range and waves.
  void FindLines(const std::string& variable) {
    for (const Instrument instrument : {kProbes, kLinkage, kRim}) {
      std::vector<std::size_t> channels;
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        if ((channels_[c].instruments & instrument) != 0) channels.push_back(c);
      }
      if (channels.empty()) continue;
      const Range range = RangeOf(variable, channels_[channels.back()], scene_);
      if (!(range.last > range.first)) continue;
      const std::vector<double> waves =
          StrongestWaves(variable, channels, instrument,
                         2.0 * std::numbers::pi * kOfAWave / (range.last - range.first));
      for (std::size_t c = 0; c < channels.size(); ++c) {
        if (waves[c] > 0.0) lines_[channels[c]].push_back({variable, range, waves[c]});
      }
    }
  }

  std::vector<double> StrongestWaves(const std::string& variable,
                                     const std::vector<std::size_t>& channels,
                                     Instrument instrument, double step) const {
    const auto count = static_cast<Index>(channels.size());
    MatrixXd scores(count, 0), weights(count, 0);
    RowVectorXd values;
    for (std::size_t run = 0; run < fit_.runs(); ++run) {
      const Trace& trace = fit_.TraceOf(run);
      if (trace.rows() == 0 || InstrumentOf(trace) != instrument) continue;
      const RowVectorXd own = ValuesOf(variable, trace);
      if (own.size() == 0) continue;
      for (MatrixXd* matrix : {&scores, &weights}) {
        matrix->conservativeResize(Eigen::NoChange, matrix->cols() + own.size());
      }
      values.conservativeResize(values.size() + own.size());
      values.tail(own.size()) = own;
      for (Index c = 0; c < count; ++c) {
        const auto of_run =
            fit_.ScoresOf(run, channels_[channels[static_cast<std::size_t>(c)]].stage);
        scores.row(c).tail(own.size()) = of_run.scores;
        weights.row(c).tail(own.size()) = of_run.weights;
      }
    }
    std::vector<double> found(channels.size(), 0.0), strongest(channels.size(), 0.0);
    if (values.size() == 0) return found;
    // From line to line by the angle of a step.
    const Eigen::ArrayXd first_cosine = (step * values.array()).cos().transpose(),
                         first_sine = (step * values.array()).sin().transpose();
    VectorXd cosine = VectorXd::Ones(values.size()), sine = VectorXd::Zero(values.size());
    for (Index line = 1; line <= kLines; ++line) {
      const double wave = step * static_cast<double>(line);
      const Eigen::ArrayXd before = cosine;
      cosine = before * first_cosine - sine.array() * first_sine;
      sine = before * first_sine + sine.array() * first_cosine;
      const Eigen::ArrayXd power =
          (scores * sine).array().square() / (weights * sine.cwiseAbs2()).array().max(1e-300) +
          (scores * cosine).array().square() / (weights * cosine.cwiseAbs2()).array().max(1e-300);
      for (std::size_t c = 0; c < channels.size(); ++c) {
        if (power[static_cast<Index>(c)] <= strongest[c]) continue;
        strongest[c] = power[static_cast<Index>(c)];
        found[c] = wave;
      }
    }
    return found;
  }

  const Fit& fit_;
  const Scene scene_;
  const std::vector<Channel> channels_;
  std::vector<std::vector<Question>> lines_;  // the strongest, for each channel
  std::vector<Found> found_;
};

}  // namespace

std::vector<Leftover> FindLeftovers(const Fit& fit) { return Questions(fit).AskAll(); }

}  // namespace abbe::diagnosis
