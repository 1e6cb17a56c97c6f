#include "compensation/nc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "failure/failure.h"

namespace abbe::compensation {
namespace {

constexpr std::size_t kPiece = 1 << 20;

// `units` of 10^-decimals, e.g. 12500000 with 6 decimals as "12.5". Written from the last digit
// backwards.
void AppendFixed(std::int64_t units, int decimals, std::string& out) {
  std::array<char, 32> text;
  char* const end = text.data() + text.size();
  char* begin = end;
  std::uint64_t digits = units < 0 ? -units : units;
  const auto take_digit = [&] {
    const char digit = static_cast<char>('0' + digits % 10);
    digits /= 10;
    return digit;
  };
  for (int i = 0; i < decimals; ++i) {
    const char digit = take_digit();
    if (begin != end || digit != '0') *--begin = digit;
  }
  if (begin != end) *--begin = '.';
  do {
    *--begin = take_digit();
  } while (digits != 0);
  if (units < 0) *--begin = '-';
  out.append(begin, end);
}

}  // namespace

void NcWriter::Word(std::string_view word) {
  if (!is_at_start_) text_ += ' ';
  text_ += word;
  is_at_start_ = false;
}

void NcWriter::EndLine() {
  text_ += '\n';
  is_at_start_ = true;
  if (static_cast<double>(++lines_) > most_lines_) {
    throw InputError(
        fmt::format("the corrected program would have more than {:.0e} lines; allow "
                    "longer ones, or larger chords, or correct it in parts",
                    most_lines_));
  }
  if (text_.size() >= kPiece && gaps_.empty() && behind_.empty()) Flush();
}

void NcWriter::LeaveGap() {
  gaps_.push_back({text_.size(), is_at_start_});
  is_at_start_ = false;
}

void NcWriter::BeginGap() {
  behind_ = text_.substr(gaps_.front().at);
  text_.resize(gaps_.front().at);
  is_at_start_ = gaps_.front().is_at_start;
}

void NcWriter::EndGap() {
  const std::size_t begin = gaps_.front().at;
  gaps_.pop_front();
  for (Gap& gap : gaps_) gap.at += text_.size() - begin;
  text_ += behind_;
  behind_.clear();
  is_at_start_ = text_.ends_with('\n');
}

void NcWriter::Flush() {
  sink_(text_);
  text_.clear();
}

void NcWriter::Motion(int motion) {
  if (motion_ == motion) return;
  Word(motion == 0 ? "G0" : "G1");
  motion_ = motion;
}

void NcWriter::Angle(char letter, std::int64_t millionths) {
  constexpr int kDecimals = 6;
  if (!is_at_start_) text_ += ' ';
  is_at_start_ = false;
  text_ += letter;
  AppendFixed(millionths, kDecimals, text_);
}

void NcWriter::Position(const Eigen::Vector3d& machine, bool is_g53) {
  const Eigen::Vector3d command = corrector_.Command(machine);
  largest_ = std::max(largest_, (command - machine).norm());
  const NcOffsets none, &offsets = is_g53 ? none : state_.control;
  const Eigen::Vector3d to = offsets.ToProgram(command);
  const Eigen::Vector3d from = state_.is_relative && !is_g53
                                   ? offsets.ToProgram(at_)
                                   : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const int decimals = state_.is_inch ? 7 : 6;
  Eigen::Vector3d written = to;
  for (int k = 0; k < 3; ++k) {
    if (!corrector_.Has(k)) continue;
    const double factor = k == 0 && state_.is_diameter ? 2.0 : 1.0;
    const double unit = state_.Unit() * (state_.is_inch ? 1e-7 : 1e-6) / factor;
    const std::int64_t units = std::llround((to[k] - from[k]) / unit);
    written[k] = from[k] + static_cast<double>(units) * unit;
    if (!is_at_start_) text_ += ' ';
    is_at_start_ = false;
    text_ += "XYZ"[k];
    AppendFixed(units, decimals, text_);
  }
  at_ = offsets.ToMachine(written);
  ++positions_;
}

}  // namespace abbe::compensation
