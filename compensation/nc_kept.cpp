#include "compensation/nc_kept.h"

#include <fmt/format.h>

#include <cmath>

#include "compensation/nc_block.h"
#include "compensation/nc_expression.h"

namespace abbe::compensation {

// The parameter or EXISTS[...] at the start of `text`, behind which `at` is put: its value, or
// itself if the control has it.
std::string NcKept::Value(std::string_view text, std::size_t line_number, std::size_t& at) const {
  NcCursor cursor(text, line_number, parameters_);
  const double value = cursor.Value();
  at += cursor.at();
  const std::string_view written = text.substr(0, cursor.at());
  NcCursor inside(written.substr(written.find('#') + 1), line_number, parameters_);
  const NcCursor::Parameter parameter = inside.ParameterName();
  const bool is_of_control = parameter.name.empty() ? NcParameters::IsOfControl(parameter.number)
                                                    : parameters_.IsOfControl(parameter.name);
  if (is_of_control) return std::string(written);
  if (std::isnan(value)) {
    cursor.Refuse(
        fmt::format("the way of the program depends on {}, which the corrected program does not "
                    "set; correct the ways apart",
                    written));
  }
  return fmt::format("[{:.9f}]", value);
}

std::string NcKept::Condition(const NcControlLine& control) const {
  NcCursor whole(control.rest, control.line + 1, parameters_);
  whole.Value();
  const std::string_view text = control.rest.substr(0, whole.at());
  std::string condition;
  for (std::size_t at = 0; at < text.size();) {
    NcCursor cursor(text.substr(at), control.line + 1, parameters_);
    const bool is_value = text[at] == '#' || (text[at] != ' ' && cursor.TakeWord("EXISTS"));
    if (is_value) {
      condition += Value(text.substr(at), control.line + 1, at);
    } else {
      condition += text[at++];
    }
  }
  return condition;
}

bool NcKept::KeepLines(const NcFile& file, std::size_t line, std::size_t end, bool is_rest) {
  const std::size_t first = line;
  for (; line < end; ++line) {
    const int index = file.ControlOf(line);
    if (index == kNone) {
      host_.TakeKept(file.Line(line), line + 1, is_rest);
      continue;
    }
    const NcControlLine& inner = file.controls[index];
    if (inner.control == NcControl::kReturn && !inner.is_deletable) return true;
    if (inner.control != NcControl::kIf || inner.is_deletable) {
      RefuseLine(line + 1,
                 fmt::format("whether this acts is known only at the control (line {}); give "
                             "--parameters or --ini, or correct the ways apart",
                             first));
    }
    const int last = Keep(file, index);
    line = file.controls[last].line;
    if (file.controls[last].control == NcControl::kEndSub) return true;
  }
  return false;
}

// The end of the subroutine around a control line.
int NcKept::EndOfSub(const NcFile& file, int control) {
  const int count = static_cast<int>(file.controls.size());
  int end = control;
  while (end < count && file.controls[end].control != NcControl::kEndSub) ++end;
  if (end == count) {
    RefuseLine(file.controls[control].line + 1, "a return outside a subroutine");
  }
  return end;
}

int NcKept::Keep(const NcFile& file, int first) {
  constexpr int kDeepestBranch = 64;
  if (depth_ == kDeepestBranch) {
    RefuseLine(file.controls[first].line + 1,
               fmt::format("branches of the control nested more than {} deep", kDeepestBranch));
  }
  ++depth_;
  const std::string name = fmt::format("O<kept{}>", ++count_);
  int branch = first, branches = 0, returns = 0;
  bool has_else = false;
  for (; file.controls[branch].control != NcControl::kEndIf; branch = file.controls[branch].next) {
    const NcControlLine& control = file.controls[branch];
    has_else = control.control == NcControl::kElse;
    if (has_else) {
      host_.WriteKept(name + " else");
    } else {
      host_.WriteKept(
          fmt::format("{} {} {}", name, branch == first ? "if" : "elseif", Condition(control)));
    }
    const std::size_t end = file.controls[control.next].line;
    ++branches;
    returns += KeepLines(file, control.line + 1, end, false) ? 1 : 0;
  }
  const int end = returns == 0 ? branch : EndOfSub(file, branch);
  if (returns > 0 && !(has_else && returns == branches)) {
    if (branches > 1) {
      RefuseLine(file.controls[first].line + 1,
                 "some branches return, by a value that only the control knows; write each return "
                 "as an if of its own");
    }
    host_.WriteKept(name + " else");
    KeepLines(file, file.controls[branch].line + 1, file.controls[end].line, true);
  }
  host_.WriteKept(name + " endif");
  --depth_;
  return end;
}

}  // namespace abbe::compensation
