// The parameters of an NC program: #5, #<depth>, #<_global>, with those of the control.
//
//   NcParameters parameters(live);
//   parameters.SetNamed("depth", 3.0);
//   parameters.Enter({1.0, 2.0});          // a subroutine: #1 and #2 are its arguments
//   parameters.Named("depth");             // nothing: names without _ belong to one level
//
// #1 to #30 and names without _ belong to a level of calls; #31 to #5000 and names with _ to the
// whole program. A value that is known only at the control while the program runs, such as the
// result of a probe, is kRuntime, which is not a number; every result of it is kRuntime too.
// Units: as the program writes them. Failure: InputError for a number that no parameter has.
// Source: LinuxCNC 2.9, G-code overview, parameters.
// Validity: the parameters of LinuxCNC; another control numbers its own differently.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace abbe::compensation {

inline constexpr double kRuntime = std::numeric_limits<double>::quiet_NaN();
inline constexpr int kArguments = 30;  // #1 to #30

// What the control itself holds: offsets, the position, the tool, the modes.
struct NcLive {
  std::function<std::optional<double>(int)> number;
  std::function<std::optional<double>(const std::string&)> name;
};

class NcParameters {
 public:
  // The values of a parameter file; without one, a parameter that was not set is kRuntime.
  using Stored = std::optional<std::map<int, double>>;

  explicit NcParameters(NcLive live = {}, Stored stored = {});

  // #number; InputError for one that there is not.
  double Number(int number) const;
  // InputError for one of the control's.
  void SetNumber(int number, double value);
  // Nothing if there is no such parameter. `name` in lower case without blanks.
  std::optional<double> Named(const std::string& name) const;
  // Whether there is one, 1 or 0; kRuntime for a pin or an entry of the INI file that may lack.
  double Exists(const std::string& name) const;
  // Whether the control holds the value of this name or number at the time, and the corrected
  // program finds it as the program does.
  bool IsOfControl(const std::string& name) const;
  static bool IsOfControl(int number);
  // Whether it ends with its level of calls: a name (empty: none) without _, or #1 to #30.
  static bool IsOfSubroutine(const std::string& name, int number);
  // Makes it if it is new.
  void SetNamed(const std::string& name, double value);

  // A level of calls with its own #1 to #30.
  void Enter(const std::vector<double>& arguments);
  // Back to the level before.
  void Leave();
  std::size_t level() const { return levels_.size() - 1; }

 private:
  struct Level {
    std::array<double, kArguments> arguments;
    std::unordered_map<std::string, double> names;
  };

  NcLive live_;
  double unset_;
  std::unordered_map<int, double> numbers_;
  std::unordered_map<std::string, double> names_;
  std::vector<Level> levels_;
};

}  // namespace abbe::compensation
