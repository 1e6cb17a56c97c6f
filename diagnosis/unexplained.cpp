#include "diagnosis/unexplained.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "diagnosis/scan.h"
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
constexpr double kOfAWave = 0.4;    // over the range, from one line to the next

const estimation::PrintUnit kMicrometres{"um", 1e-6}, kMicroradians{"urad", 1e-6};

// The instruments that runs are recorded with.
enum Instrument : unsigned { kProbes = 1, kLinkage = 2, kRim = 4 };

Instrument InstrumentOf(const Trace& trace) {
  if (trace.rim) return kRim;
  return trace.head ? kProbes : kLinkage;
}

struct Channel {
  std::string object;
  Index stage;
  estimation::PrintUnit unit;
  unsigned instruments;  // whose runs feel it

  // Whether so much could be left at all.
  bool IsPlausible(double amount) const { return unit.name != kMicrometres.name || amount < 1e-3; }
};

std::vector<Channel> ChannelsOf(const Scene& scene) {
  std::vector<Channel> channels;
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

bool Feels(const Channel& channel, const Trace& trace) {
  return (channel.instruments & InstrumentOf(trace)) != 0;
}

struct Range {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();

  double Length() const { return last - first; }
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
  double length = 0.0;  // of the coefficients

  // Natural logarithm of the probability of as much by chance, of the strongest among so many.
  double LogProbability(double among) const {
    if (freedom == 0) return 0.0;
    const boost::math::chi_squared distribution(freedom);
    const double one = boost::math::cdf(boost::math::complement(distribution, chi_square));
    const double log_one = one > 0.0 ? std::log(one) : -0.5 * chi_square;
    return std::min(0.0, log_one + std::log(among));
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
  answer.length = found.norm();
  return answer;
}

class Questions {
 public:
  explicit Questions(const Fit& fit)
      : fit_(fit),
        scene_(fit.campaign().scene()),
        channels_(ChannelsOf(scene_)),
        searched_(channels_.size()) {}

  std::vector<Leftover> AskAll() {
    for (const std::string& variable : PeriodicVariablesOf(scene_)) Search(variable);
    for (std::size_t channel = 0; channel < channels_.size(); ++channel) Ask(channel);
    std::sort(found_.begin(), found_.end(),
              [](const Found& a, const Found& b) { return a.log_probability < b.log_probability; });
    const auto questions = static_cast<double>(found_.size());
    std::vector<Leftover> leftovers;
    for (Found& each : found_) {
      const auto same = [&](const Leftover& other) {
        return other.object == channels_[each.channel].object;
      };
      if (std::any_of(leftovers.begin(), leftovers.end(), same)) continue;
      const double p_value = std::min(1.0, std::exp(each.log_probability) * questions);
      if (p_value >= kDoubt) continue;
      Sharpen(each);
      leftovers.push_back(Told(each));
      leftovers.back().p_value = std::min(p_value, std::exp(each.log_probability) * questions);
    }
    return leftovers;
  }

 private:
  // kTerms cosines of a variable over its range, or a line of it, or an interval.
  struct Question {
    std::string variable;
    Range range;
    double wave = 0.0;  // of the line
    Interval interval = {};

    Index columns() const { return wave > 0.0 ? 2 : interval.IsEmpty() ? kTerms : 1; }
    // The number of those among which it is the strongest.
    double among() const {
      return wave > 0.0 ? static_cast<double>(kLines) : interval.IsEmpty() ? 1.0 : kIntervals;
    }
  };
  struct Found {
    std::size_t channel;
    Question question;
    Answer answer;
    double log_probability;
  };

  Leftover Told(const Found& found) const {
    const Channel& channel = channels_[found.channel];
    const Question& asked = found.question;
    const double amplitude = channel.instruments == kRim ? RmsOf(found.answer, channel)
                             : asked.interval.IsEmpty()  ? found.answer.length / std::numbers::sqrt2
                                                         : found.answer.length;
    return {asked.variable,
            channel.object,
            amplitude,
            channel.unit,
            1.0,
            asked.wave > 0.0 ? 2.0 * std::numbers::pi / asked.wave : 0.0,
            asked.interval.from,
            asked.interval.to};
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
    if (!question.interval.IsEmpty()) {
      const auto within =
          values.array() >= question.interval.from && values.array() < question.interval.to;
      return {simulation::InStage(trace, channel.stage, within.cast<double>())};
    }
    std::vector<Disturbance> columns;
    const double length = question.range.Length();
    for (Index term = 1; term <= kTerms; ++term) {
      const double waves = std::numbers::pi * static_cast<double>(term) / length;
      columns.push_back(simulation::InStage(
          trace, channel.stage, (waves * (values.array() - question.range.first)).cos()));
    }
    return columns;
  }

  // All questions of a channel together: they share its stage.
  std::vector<Found> Asked(std::size_t which, const std::vector<Question>& questions) const {
    const Channel& channel = channels_[which];
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
    std::vector<Found> found;
    for (std::size_t q = 0; q < questions.size(); ++q) {
      Answer answer = Explained(projections[q]);
      if (!channel.IsPlausible(answer.length)) answer = {};
      found.push_back({which, questions[q], answer, answer.LogProbability(questions[q].among())});
    }
    return found;
  }

  void Ask(std::size_t channel) {
    std::vector<Question> questions = searched_[channel];
    for (const std::string& variable : VariablesOf(scene_)) {
      const Range range = RangeOf(variable, channels_[channel], scene_);
      if (range.last > range.first) questions.push_back({variable, range});
    }
    for (Found& found : Asked(channel, questions)) found_.push_back(std::move(found));
  }

  // The scan does not know what else may take in a part of an effect, and stops at an edge of it:
  // moves the borders as long as more is explained.
  void Sharpen(Found& found) const {
    const double cell = found.question.range.Length() / static_cast<double>(kLines);
    const double end =
        std::nextafter(found.question.range.last, std::numeric_limits<double>::infinity());
    for (bool better = !found.question.interval.IsEmpty(); better;) {
      const auto [from, to] = found.question.interval;
      std::vector<Question> others;
      const auto add = [&](Interval interval) {
        const Range& range = found.question.range;
        interval.from = std::max(interval.from, range.first);
        interval.to = std::min(interval.to, end);
        if (interval.to - interval.from < 0.5 * cell) return;
        others.push_back({found.question.variable, range, 0.0, interval});
      };
      for (Index cells = 1; cells < kLines; cells *= 2) {
        const double step = cell * static_cast<double>(cells);
        add({from - step, to});
        add({from + step, to});
        add({from, to - step});
        add({from, to + step});
        add({from - step, from});
        add({to, to + step});
      }
      better = false;
      for (Found& other : Asked(found.channel, others)) {
        if (other.answer.chi_square <= found.answer.chi_square) continue;
        found = std::move(other);
        better = true;
      }
    }
  }

  // The explained part, over the rows. Where a shaft turns evenly, time and the harmonics that
  // are known go together, and the coefficients of the answer are larger than what they do.
  double RmsOf(const Answer& answer, const Channel& channel) const {
    double weight = 0.0;
    for (std::size_t run = 0; run < fit_.runs(); ++run) {
      if (InstrumentOf(fit_.TraceOf(run)) != kRim) continue;
      weight += fit_.ScoresOf(run, channel.stage).weights.sum();
    }
    return std::sqrt(answer.chi_square / weight);
  }

  // The strongest line and the strongest interval of each channel, to be asked as they should be.
  // Channels of one kind of run share range and waves.
  void Search(const std::string& variable) {
    for (const Instrument instrument : {kProbes, kLinkage, kRim}) {
      std::vector<std::size_t> channels;
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        if ((channels_[c].instruments & instrument) != 0) channels.push_back(c);
      }
      if (channels.empty()) continue;
      const Range range = RangeOf(variable, channels_[channels.back()], scene_);
      if (!(range.last > range.first)) continue;
      const Scan scan = ScanOf(variable, channels, instrument);
      const std::vector<double> waves =
          StrongestWaves(scan, 2.0 * std::numbers::pi * kOfAWave / range.Length());
      const std::vector<Interval> intervals = StrongestIntervals(scan);
      for (std::size_t c = 0; c < channels.size(); ++c) {
        auto& searched = searched_[channels[c]];
        if (waves[c] > 0.0) searched.push_back({variable, range, waves[c]});
        if (!intervals[c].IsEmpty()) searched.push_back({variable, range, 0.0, intervals[c]});
      }
    }
  }

  Scan ScanOf(const std::string& variable, const std::vector<std::size_t>& channels,
              Instrument instrument) const {
    const auto count = static_cast<Index>(channels.size());
    Scan scan{{}, MatrixXd(count, 0), MatrixXd(count, 0)};
    for (std::size_t run = 0; run < fit_.runs(); ++run) {
      const Trace& trace = fit_.TraceOf(run);
      if (trace.rows() == 0 || InstrumentOf(trace) != instrument) continue;
      const RowVectorXd own = ValuesOf(variable, trace);
      if (own.size() == 0) continue;
      for (MatrixXd* matrix : {&scan.scores, &scan.weights}) {
        matrix->conservativeResize(Eigen::NoChange, matrix->cols() + own.size());
      }
      scan.values.conservativeResize(scan.values.size() + own.size());
      scan.values.tail(own.size()) = own;
      for (Index c = 0; c < count; ++c) {
        const auto of_run =
            fit_.ScoresOf(run, channels_[channels[static_cast<std::size_t>(c)]].stage);
        scan.scores.row(c).tail(own.size()) = of_run.scores;
        scan.weights.row(c).tail(own.size()) = of_run.weights;
      }
    }
    return scan;
  }

  const Fit& fit_;
  const Scene scene_;
  const std::vector<Channel> channels_;
  std::vector<std::vector<Question>> searched_;  // the strongest, for each channel
  std::vector<Found> found_;
};

}  // namespace

std::vector<Leftover> FindLeftovers(const Fit& fit) { return Questions(fit).AskAll(); }

}  // namespace abbe::diagnosis
