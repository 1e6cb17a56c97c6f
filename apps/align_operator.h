// The operator of `abbe align`: sees position and gaps, is asked to move and to turn, and confirms
// with the Enter key.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/key_press.h"
#include "apps/live_view.h"
#include "hal/clock.h"
#include "hal/sample_source.h"
#include "hal/standstill.h"
#include "probes/head_layout.h"
#include "recording/recording_file.h"

namespace abbe::apps {

// Where the gaps and the position of the axis are among the channels of the devices.
struct GapChannels {
  probes::PerProbe<std::size_t> gap{};
  std::optional<std::size_t> position;

  // InputError, which names the machine file, where a gap is missing.
  GapChannels(const std::vector<hal::Channel>& channels, char axis, const std::string& machine);
};

class AlignOperator {
 public:
  // `rate` in Hz; `view` may be null. All must outlive the operator.
  AlignOperator(const GapChannels& channels, char axis, double rate, hal::Clock& clock,
                hal::SampleSource& source, LiveView* view);

  // In the terminal and on the page.
  void Ask(const std::string& what);
  // The readings of `seconds` after the key, with all of them shown until then; nothing when the
  // operator ends it.
  std::optional<hal::Standstill> AwaitStandstill(double seconds);

 private:
  // On the terminal and on the page.
  void Show(const hal::SampleSet& set);
  // A line on the terminal with the present position and gaps, ten times a second.
  void ShowLine(const hal::SampleSet& set);

  const GapChannels& channels_;
  char axis_;
  double rate_;
  hal::Clock& clock_;
  hal::SampleSource& source_;
  LiveView* view_;
  std::unique_ptr<recording::Writer> feed_;
  std::vector<double> row_;
  std::optional<double> first_s_;
  double shown_s_ = -1.0;
  KeyPress keys_;
};

}  // namespace abbe::apps
