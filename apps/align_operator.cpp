#include "apps/align_operator.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "failure/failure.h"

namespace abbe::apps {

GapChannels::GapChannels(const std::vector<hal::Channel>& channels, char axis,
                         const std::string& machine) {
  const auto find = [&](const std::string& name) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (channels[i].name == name) return i;
    }
    return {};
  };
  for (std::size_t i = 0; i < gap.size(); ++i) {
    const std::string name = fmt::format("probe_{:c}_um", 'a' + i);
    const auto found = find(name);
    if (!found) {
      throw InputError(fmt::format(
          "{}: no device has the channel {}; an alignment needs all five gaps", machine, name));
    }
    gap[i] = *found;
  }
  position = find(fmt::format("{:c}_mm", axis - 'X' + 'x'));
}

AlignOperator::AlignOperator(const GapChannels& channels, char axis, double rate, hal::Clock& clock,
                             hal::SampleSource& source, LiveView* view)
    : channels_(channels),
      axis_(axis),
      rate_(rate),
      clock_(clock),
      source_(source),
      view_(view),
      row_(source.channels().size() + 1) {
  if (view_ == nullptr) return;
  std::vector<std::string> columns = {"time_s"};
  for (const hal::Channel& channel : source.channels()) columns.push_back(channel.name);
  feed_ = view_->Watch(nullptr, columns, {});
}

void AlignOperator::Ask(const std::string& what) {
  fmt::print("{}\n", what);
  std::fflush(stdout);
  if (view_ != nullptr) view_->Show({.note = "At the terminal: " + what});
}

std::optional<hal::Standstill> AlignOperator::AwaitStandstill(double seconds) {
  auto standstill = hal::AwaitStandstill(source_, clock_,
                                         {.rate = rate_,
                                          .seconds = seconds,
                                          .confirmed = [&] { return keys_.Poll(); },
                                          .shown = [&](const hal::SampleSet& set) { Show(set); }});
  if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r\x1b[K");
  return standstill;
}

void AlignOperator::Show(const hal::SampleSet& set) {
  ShowLine(set);
  if (!feed_) return;
  if (!first_s_) first_s_ = set.time_s;
  row_[0] = set.time_s - *first_s_;
  for (std::size_t i = 0; i < set.samples.size(); ++i) row_[i + 1] = set.samples[i].value;
  feed_->Append(row_);
}

void AlignOperator::ShowLine(const hal::SampleSet& set) {
  if (isatty(STDERR_FILENO) == 0 || set.time_s < shown_s_ + 0.1) return;
  shown_s_ = set.time_s;
  fmt::print(stderr, "\r");
  if (channels_.position) {
    fmt::print(stderr, "{:c} {:9.3f} mm ", axis_, set.samples[*channels_.position].value);
  }
  for (std::size_t i = 0; i < channels_.gap.size(); ++i) {
    const hal::Sample& sample = set.samples[channels_.gap[i]];
    fmt::print(stderr, " {:c} {:>9}", 'a' + i,
               sample.good() ? fmt::format("{:.2f}", sample.value)
                             : std::string(hal::NameOf(sample.cause)).substr(0, 9));
  }
  fmt::print(stderr, " um\x1b[K");
  std::fflush(stderr);
}

}  // namespace abbe::apps
