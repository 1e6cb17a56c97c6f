#include "hal/can/candump_log.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "failure/failure.h"
#include "recording/line_reader.h"
#include "recording/whole_file.h"

namespace abbe::hal {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;  // in an identifier of eight digits
constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;

std::string_view TakeWord(std::string_view& text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return text = {};
  const auto end = std::min(text.find_first_of(" \t", begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

template <class Number>
std::optional<Number> NumberOf(std::string_view digits, int base) {
  Number number{};
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
  if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size()) return {};
  return number;
}

// "(1763716800.250103)" in microseconds.
std::optional<std::int64_t> StampOf(std::string_view word) {
  constexpr std::size_t kDecimals = 6;
  if (word.size() < kDecimals + 4 || word.front() != '(' || word.back() != ')') return {};
  word = word.substr(1, word.size() - 2);
  const auto point = word.find('.');
  if (point == std::string_view::npos || word.size() - point - 1 != kDecimals) return {};
  const auto seconds = NumberOf<std::uint32_t>(word.substr(0, point), 10);
  const auto rest = NumberOf<std::uint32_t>(word.substr(point + 1), 10);
  if (!seconds || !rest) return {};
  return *seconds * kMicrosecondsPerSecond + *rest;
}

bool ReadData(std::string_view text, CanFrame& frame) {
  if (!text.empty() && text[0] == 'R') {
    frame.remote = true;
    text.remove_prefix(1);
    const auto size = text.empty() ? std::optional<int>(0) : NumberOf<int>(text, 10);
    if (!size || *size < 0 || *size > 8) return false;
    frame.size = static_cast<std::uint8_t>(*size);
    return true;
  }
  if (text.size() % 2 != 0 || text.size() > 2 * frame.data.size()) return false;
  frame.size = static_cast<std::uint8_t>(text.size() / 2);
  for (std::size_t i = 0; i < frame.size; ++i) {
    const auto byte = NumberOf<std::uint8_t>(text.substr(2 * i, 2), 16);
    if (!byte) return false;
    frame.data[i] = *byte;
  }
  return true;
}

enum class Form { kFrame, kPassedOver, kWrong };

Form ReadFrame(std::string_view word, CanFrame& frame) {
  const auto hash = word.find('#');
  if (hash != 3 && hash != 8) return Form::kWrong;
  const auto id = NumberOf<std::uint32_t>(word.substr(0, hash), 16);
  if (!id) return Form::kWrong;
  if (hash == 8 && (*id & kErrorFlag) != 0) return Form::kPassedOver;
  if (word.substr(hash).starts_with("##")) return Form::kPassedOver;
  frame.extended = hash == 8;
  frame.id = *id;
  if (frame.id > (frame.extended ? 0x1FFFFFFFu : 0x7FFu)) return Form::kWrong;
  return ReadData(word.substr(hash + 1), frame) ? Form::kFrame : Form::kWrong;
}

// One line; false when it is not one of candump's.
bool ReadLine(std::string_view line, std::int64_t& last_us, bool& goes_back, CandumpLog& log) {
  const auto stamp = StampOf(TakeWord(line));
  const std::string_view interface = TakeWord(line), word = TakeWord(line), way = TakeWord(line);
  if (!stamp || interface.empty() || !(way.empty() || way == "R" || way == "T")) return false;
  CanFrame frame;
  const Form form = ReadFrame(word, frame);
  if (form == Form::kWrong) return false;
  if (form == Form::kPassedOver) {
    ++log.passed_over;
    return true;
  }
  if (log.frames.empty()) log.started_us = last_us = *stamp;
  goes_back = goes_back || *stamp < last_us;
  last_us = std::max(last_us, *stamp);
  log.frames.push_back({1e-6 * (last_us - log.started_us), std::string(interface), frame});
  return true;
}

std::string LineOf(const LoggedFrame& logged, std::int64_t started_us) {
  const std::int64_t stamp = started_us + std::llround(1e6 * logged.time_s);
  const CanFrame& frame = logged.frame;
  std::string line = fmt::format("({}.{:06}) {} ", stamp / kMicrosecondsPerSecond,
                                 stamp % kMicrosecondsPerSecond, logged.interface);
  line += frame.extended ? fmt::format("{:08X}#", frame.id) : fmt::format("{:03X}#", frame.id);
  if (frame.remote) return line + 'R';
  for (std::size_t i = 0; i < frame.size; ++i) line += fmt::format("{:02X}", frame.data[i]);
  return line;
}

}  // namespace

CandumpLog ReadCandump(const std::filesystem::path& path) {
  CandumpLog log;
  log.name = path.string();
  recording::LineReader lines(path);
  std::int64_t last_us = 0;
  bool goes_back = false;
  while (const auto line = lines.Next()) {
    if (line->empty()) continue;
    if (!lines.complete()) {
      log.warnings.push_back(
          fmt::format("{}:{}: the last line has no end: it is dropped", log.name, lines.number()));
    } else if (!ReadLine(*line, last_us, goes_back, log)) {
      throw InputError(
          fmt::format("{}:{}: is no line of candump -l, as in \"(1763716800.250103) can0 "
                      "181#DEADBEEF\"; log with candump -l or -L",
                      log.name, lines.number()));
    }
  }
  if (log.frames.empty()) {
    throw InputError(fmt::format("{}: has no CAN frames; log with candump -l", log.name));
  }
  if (goes_back) {
    log.warnings.push_back(
        fmt::format("{}: its stamps go back in places (the computer's calendar was set): such "
                    "frames bear the stamp ahead of them",
                    log.name));
  }
  return log;
}

void WriteCandump(const CandumpLog& log, const std::filesystem::path& path) {
  recording::WholeFile file(path);
  for (const LoggedFrame& frame : log.frames) file.Append(LineOf(frame, log.started_us) + '\n');
  file.Finish();
}

}  // namespace abbe::hal
