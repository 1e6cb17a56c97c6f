#include "compensation/nc_flow.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "compensation/nc_block.h"
#include "compensation/nc_kept.h"
#include "failure/failure.h"

namespace abbe::compensation {
namespace {

struct Repeat {
  int loop;  // index of its control line
  double left;
};

// A running file or subroutine.
struct Frame {
  const NcFile* file;
  std::size_t line;  // the next
  bool is_call;
  std::vector<Repeat> repeats;
};

constexpr std::string_view kOnlyAtControl =
    "the way of the program depends on a value that is known only at the control (a probe, an "
    "input, a parameter without a value); give --parameters or --ini, or correct the ways apart";

class Flow {
 public:
  Flow(NcSource& source, NcParameters& parameters, NcHost& host)
      : source_(source), parameters_(parameters), host_(host), kept_(parameters, host) {
    frames_.push_back({&source.main(), 0, false, {}});
  }

  void Run() {
    while (Step()) {
    }
  }

 private:
  Frame& Top() { return frames_.back(); }
  const NcControlLine& At(int index) { return Top().file->controls[index]; }

  bool Step() {
    Frame& top = Top();
    if (top.line >= top.file->starts.size()) {
      if (!top.is_call) return false;
      Return(top.file->starts.size());
      return true;
    }
    const std::size_t index = top.line++;
    const NcFile& file = *top.file;
    try {
      if (++steps_ > host_.MostSteps()) {
        RefuseLine(index + 1, fmt::format("the program has not ended after {} lines; does its loop "
                                          "end? Write it out in parts",
                                          host_.MostSteps()));
      }
      const int control = file.ControlOf(index);
      if (control != kNone) {
        Follow(control);
        return true;
      }
      return host_.Take(file.Line(index), index + 1);
    } catch (const InputError& failure) {
      if (&file == &source_.main()) throw;
      throw InputError(fmt::format("{}: {}", file.name, failure.what()));
    }
  }

  void GoBehind(int control) { Top().line = At(control).line + 1; }
  void GoTo(int control) { Top().line = At(control).line; }

  // kRuntime where only the control knows it.
  double ValueOrRuntime(const NcControlLine& control) {
    NcCursor cursor(control.rest, control.line + 1, parameters_);
    if (cursor.Peek() != '[') cursor.Refuse("a condition or a number in [ ] is missing");
    const double value = cursor.Value();
    MustEnd(cursor);
    return value;
  }

  double Value(const NcControlLine& control) {
    const double value = ValueOrRuntime(control);
    if (std::isnan(value)) RefuseLine(control.line + 1, std::string(kOnlyAtControl));
    return value;
  }

  static void MustEnd(NcCursor& cursor) {
    const char next = cursor.Peek();
    if (next != '\0' && next != '(' && next != ';') {
      cursor.Refuse(fmt::format("\"{}\" behind an O word", cursor.Rest().substr(0, 10)));
    }
  }

  // Leaves the loops within `loop`, and `loop` itself if wanted.
  void LeaveLoops(int loop, bool too) {
    auto& repeats = Top().repeats;
    while (!repeats.empty() && repeats.back().loop >= loop + (too ? 0 : 1)) repeats.pop_back();
  }

  // The first branch from `branch` on whose condition holds.
  void Choose(int branch) {
    while (true) {
      const NcControlLine& control = At(branch);
      if (control.control == NcControl::kElse || control.control == NcControl::kEndIf) {
        return GoBehind(branch);
      }
      const double value = ValueOrRuntime(control);
      if (std::isnan(value)) return Keep(branch);
      if (value != 0.0) return GoBehind(branch);
      branch = control.next;
    }
  }

  // The control chooses from `branch` on.
  void Keep(int branch) {
    const int end = kept_.Keep(*Top().file, branch);
    if (At(end).control != NcControl::kEndSub) return GoBehind(end);
    const std::size_t line_number = At(end).line + 1;
    if (!Top().is_call) RefuseLine(line_number, "a return outside a subroutine");
    parameters_.SetNamed("_value", kRuntime);
    parameters_.SetNamed("_value_returned", kRuntime);
    Return(line_number);
  }

  void Follow(int index) {
    const NcControlLine& control = At(index);
    if (control.is_deletable && host_.Deletes(control.line + 1)) {
      const bool is_single =
          control.control == NcControl::kCall || control.control == NcControl::kReturn ||
          control.control == NcControl::kBreak || control.control == NcControl::kContinue;
      if (is_single) return;
      RefuseLine(control.line + 1, "part of a loop, a branch or a subroutine is left out (/)");
    }
    switch (control.control) {
      case NcControl::kSub:
        return GoBehind(control.end);  // its definition
      case NcControl::kEndSub:
      case NcControl::kReturn:
        return ReturnValue(control);
      case NcControl::kCall:
        return Call(control);
      case NcControl::kIf:
        return Choose(index);
      case NcControl::kElseIf:
      case NcControl::kElse:
        return GoBehind(control.end);  // behind a branch that was taken
      case NcControl::kEndIf:
      case NcControl::kDo:
        return;
      case NcControl::kWhile:
        if (Value(control) == 0.0) GoBehind(control.end);
        return;
      case NcControl::kEndWhile:
        return GoTo(control.next);
      case NcControl::kWhileOfDo:
        if (Value(control) != 0.0) GoBehind(control.next);
        return;
      case NcControl::kRepeat: {
        const double count = std::round(Value(control));
        if (count < 1.0) return GoBehind(control.end);
        Top().repeats.push_back({index, count});
        return;
      }
      case NcControl::kEndRepeat:
        if (--Top().repeats.back().left >= 1.0) {
          GoBehind(control.next);
        } else {
          Top().repeats.pop_back();
        }
        return;
      case NcControl::kBreak:
        LeaveLoops(control.next, true);
        return GoBehind(At(control.next).end);
      case NcControl::kContinue:
        LeaveLoops(control.next, false);
        return GoTo(At(control.next).end);
    }
  }

  void Call(const NcControlLine& control) {
    NcCursor cursor(control.rest, control.line + 1, parameters_);
    std::vector<double> arguments;
    while (cursor.Peek() == '[') {
      if (arguments.size() == kArguments) cursor.Refuse("more than 30 arguments");
      arguments.push_back(cursor.Value());
    }
    MustEnd(cursor);
    const auto place = source_.Find(control.name, *Top().file);
    if (!place) {
      RefuseLine(control.line + 1,
                 fmt::format("no subroutine O<{0}> in the program, and no {0}.ngc beside it; name "
                             "its folder with --subroutines",
                             control.name));
    }
    if (parameters_.level() == kLevels) {
      RefuseLine(control.line + 1,
                 fmt::format("subroutines call each other more than {} deep, which LinuxCNC "
                             "refuses too",
                             kLevels));
    }
    parameters_.Enter(arguments);
    host_.Enter();
    const std::size_t begin = place->file->controls[place->control].line + 1;
    frames_.push_back({place->file, begin, true, {}});
  }

  void ReturnValue(const NcControlLine& control) {
    if (!Top().is_call) RefuseLine(control.line + 1, "a return outside a subroutine");
    NcCursor cursor(control.rest, control.line + 1, parameters_);
    const bool has_value = cursor.Peek() == '[';
    const double value = has_value ? cursor.Value() : 0.0;
    MustEnd(cursor);
    parameters_.SetNamed("_value", value);
    parameters_.SetNamed("_value_returned", has_value ? 1.0 : 0.0);
    Return(control.line + 1);
  }

  void Return(std::size_t line_number) {
    frames_.pop_back();
    parameters_.Leave();
    host_.Leave(line_number);
  }

  NcSource& source_;
  NcParameters& parameters_;
  NcHost& host_;
  NcKept kept_;
  std::vector<Frame> frames_;
  std::size_t steps_ = 0;
};

}  // namespace

void RunProgram(NcSource& source, NcParameters& parameters, NcHost& host) {
  Flow(source, parameters, host).Run();
}

}  // namespace abbe::compensation
