// What a control does with a table file, written after the lines `// sign = ...` of the file itself
// and after nothing else: no code of the writers, no kinematics of abbe.
//
//   const ForeignTables tables(text);            // an ISG or an Etalon file
//   tables.ErrorAt(position, p_TQ)               // of the tool in the workpiece, m
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace abbe::map {

class ForeignTables {
 public:
  explicit ForeignTables(const std::string& text) {
    const bool isg = text.find('[', text.find("\n[") + 1) == std::string::npos ||
                     text.find("Gridpoints") == std::string::npos;
    std::istringstream lines(text);
    std::vector<std::string> names;
    std::string section;
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("//", 0) == 0) {
        Comment(line.substr(2));
      } else if (isg) {
        IsgLine(line, names);
      } else {
        EtalonLine(line, section);
      }
    }
  }

  // "The carriage's reference point": where all axes have their origin. Positions and EXX, EYY, EZZ
  // as the control counts, the others along the machine; what stands before b carries the
  // workpiece.
  Eigen::Vector3d ErrorAt(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const {
    const std::size_t bed = chain_.find('b');
    const std::string work = chain_.substr(0, bed), tool = chain_.substr(bed + 1);
    Eigen::Isometry3d table = Eigen::Isometry3d::Identity(), spindle = table;
    for (auto axis = work.rbegin(); axis != work.rend(); ++axis)
      table = table * Pose(*axis, position);
    for (const char axis : tool) spindle = spindle * Pose(axis, position);
    Eigen::Vector3d nominal = p_TQ;
    for (const char axis : work) nominal[axis - 'X'] -= Sense(axis) * position[axis - 'X'];
    for (const char axis : tool) nominal[axis - 'X'] += position[axis - 'X'];
    return table.inverse() * (spindle * p_TQ) - nominal;
  }

  double Value(const std::string& error, double position) const {
    const auto found = tables_.find(error);
    if (found == tables_.end()) return 0.0;
    const auto& points = found->second;
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].first < position) ++i;
    const auto [a, fa] = points[i - 1];
    const auto [b, fb] = points[i];
    return fa + (fb - fa) * (position - a) / (b - a);
  }

  const std::vector<std::string>& sign() const { return sign_; }

 private:
  static double UnitOf(const std::string& error) {
    return error[0] == 'E' && error[1] >= 'X' ? 1e-3 : 1.0;
  }

  void Comment(const std::string& text) {
    const std::size_t equals = text.find(" = ");
    if (equals == std::string::npos) return;
    const std::string key = text.substr(1, equals - 1), value = text.substr(equals + 3);
    if (key == "sign") sign_.push_back(value);
    if (key == "positive") {
      std::istringstream words(value);
      for (std::string& word : positive_) words >> word;
    }
    if (key != "chain") return;
    for (const char letter : value) {
      if ((letter >= 'X' && letter <= 'Z') || letter == 'b') chain_ += letter;
    }
  }

  void IsgLine(const std::string& line, std::vector<std::string>& names) {
    std::istringstream words(line);
    std::vector<std::string> found;
    for (std::string word; words >> word;) found.push_back(word);
    if (found.empty()) return;
    if (found[0] == "#") {
      names.clear();
    } else if (names.empty()) {
      names = found;
    } else {
      for (std::size_t i = 0; i < names.size(); ++i) {
        const double value = std::stod(found[i]) * UnitOf(names[i] == names[0] ? "A" : names[i]);
        if (names[0].size() > 1) constants_[names[i]] = value;
        if (names[0].size() == 1 && i > 0) {
          tables_[names[i]].emplace_back(1e-3 * std::stod(found[0]), value);
        }
      }
    }
  }

  void EtalonLine(const std::string& line, std::string& section) {
    if (line.empty() || line[0] == '}' || line.rfind("Gridpoints", 0) == 0) return;
    if (line[0] == '[') {
      section = line.substr(1, 3);
    } else if (line.rfind("VALUE", 0) == 0) {
      constants_[section] = std::stod(line.substr(line.find('=') + 1));
    } else {
      std::istringstream words(line);
      double position = 0.0, value = 0.0;
      words >> position >> value;
      tables_[section].emplace_back(1e-3 * position, value * UnitOf(section));
    }
  }

  bool Carries(char axis) const { return chain_.find(axis) < chain_.find('b'); }
  double Sense(char axis) const {
    return Carries(axis) && positive_[static_cast<std::size_t>(axis - 'X')] == "tool" ? -1.0 : 1.0;
  }
  double Constant(const std::string& name) const {
    const auto found = constants_.find(name);
    return found == constants_.end() ? 0.0 : found->second;
  }

  static Eigen::Matrix3d Turn(const Eigen::Vector3d& v) {
    if (v.norm() == 0.0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix();
  }

  Eigen::Isometry3d Pose(char axis, const Eigen::Vector3d& position) const {
    const int k = axis - 'X';
    const auto at = [&](char motion) { return Value({'E', motion, axis}, position[k]); };
    Eigen::Vector3d line = Eigen::Vector3d::Unit(k);
    if (axis == 'Y') line = Turn({0.0, 0.0, Constant("C0Y")}) * line;
    if (axis == 'Z') line = Turn({Constant("A0Z"), Constant("B0Z"), 0.0}) * line;
    Eigen::Vector3d shift(at('X'), at('Y'), at('Z'));
    shift[k] *= Sense(axis);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Turn({at('A'), at('B'), at('C')});
    pose.translation() = Sense(axis) * position[k] * line + shift;
    return pose;
  }

  std::string chain_;
  std::array<std::string, 3> positive_;
  std::vector<std::string> sign_;
  std::map<std::string, std::vector<std::pair<double, double>>> tables_;
  std::map<std::string, double> constants_;
};

}  // namespace abbe::map
