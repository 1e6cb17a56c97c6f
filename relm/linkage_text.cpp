#include "relm/linkage_text.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <string_view>
#include <vector>

#include "failure/failure.h"
#include "settings/document.h"
#include "settings/unit.h"

namespace abbe::relm {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

const double kDegreeOfText = settings::UnitOf("_deg").si;
constexpr double kRoundedText = 1e-8;  // m: the rounding of the text, over an arm of some metres

std::string_view Unindented(std::string_view line) {
  const auto first = line.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : line.substr(first);
}

// Whether a line begins the value of a key of this name.
bool Sets(std::string_view line, std::string_view key) {
  if (!line.starts_with(key)) return false;
  return Unindented(line.substr(key.size())).starts_with('=');
}

int Depth(std::string_view line) {
  int depth = 0;
  for (const char c : line.substr(0, line.find('#'))) depth += c == '[' ? 1 : c == ']' ? -1 : 0;
  return depth;
}

// The lines without the geometry of the table [linkage].
std::vector<std::string> WithoutGeometry(const std::string& text) {
  std::vector<std::string> kept;
  std::istringstream in(text);
  std::string line, table;
  int open = 0;  // brackets of a value that is left out
  while (std::getline(in, line)) {
    const std::string_view trimmed = Unindented(line);
    if (open > 0) {
      open += Depth(trimmed);
      continue;
    }
    if (trimmed.starts_with('[')) table = trimmed.substr(0, trimmed.find_last_of(']') + 1);
    if (table == "[[linkage.joint]]" || table == "[[linkage.axis]]") continue;
    const bool geometry =
        Sets(trimmed, "joint") || Sets(trimmed, "axis") || Sets(trimmed, "ball_mm");
    if (table == "[linkage]" && geometry) {
      open = Depth(trimmed);
      continue;
    }
    kept.push_back(line);
  }
  return kept;
}

std::string InBrackets(const Vector3d& v, double unit, int digits) {
  return fmt::format("[{:.{}f}, {:.{}f}, {:.{}f}]", v.x() / unit, digits, v.y() / unit, digits,
                     v.z() / unit, digits);
}

std::string Pieces(const std::vector<std::string>& keys, const VectorXd& u95) {
  std::string text;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const double value = u95[i];
    if (!(value > 0.0)) continue;  // held
    const double unit = keys[i].ends_with("deg")  ? kDegreeOfText
                        : keys[i].ends_with("mm") ? settings::kMillimetre
                                                  : 1.0;
    text += fmt::format("{} {} {:.2g}", text.empty() ? "" : ",", keys[i], value / unit);
  }
  return text.empty() ? "" : "  # U95:" + text;
}

std::string GeometryText(const WrittenChain& written, const VectorXd& u95) {
  Eigen::Index at = 0;
  const auto next = [&](const std::vector<std::string>& keys) {
    const Eigen::Index count = keys.size();
    at += count;
    return Pieces(keys, u95.segment(at - count, count));
  };
  std::string text = written.rows.empty() ? "axis = [\n" : "joint = [\n";
  for (const DenavitHartenbergRow& row : written.rows) {
    text += fmt::format(
        "  {{ theta_deg = {:.8f}, d_mm = {:.6f}, a_mm = {:.6f}, alpha_deg = {:.8f}{} }},{}\n",
        row.theta / kDegreeOfText, row.d / settings::kMillimetre, row.a / settings::kMillimetre,
        row.alpha / kDegreeOfText, row.fixed ? ", fixed = true" : "",
        next({"theta_deg", "d_mm", "a_mm", "alpha_deg"}));
  }
  for (const JointAxis& axis : written.axes) {
    text += fmt::format("  {{ point_mm = {}, direction = {} }},{}\n",
                        InBrackets(axis.point, settings::kMillimetre, 6),
                        InBrackets(axis.direction, 1.0, 12),
                        next({"x_mm", "y_mm", "z_mm", "direction x", "y", "z"}));
  }
  return text + "]\nball_mm = " + InBrackets(written.ball, settings::kMillimetre, 6) +
         next({"x_mm", "y_mm", "z_mm"}) + "\n";
}

void RefuseOther(const std::string& text, const WrittenChain& written, const std::string& name) {
  const auto document = settings::Document::Parse(text, name);
  const SerialChain read = ReadLinkageSettings(document.Root()).chain, chain = written.Chain();
  for (double angle : {0.0, 0.7, -1.9}) {
    const VectorXd q = VectorXd::Constant(chain.joints(), angle);
    if (read.joints() == chain.joints() && (read.Tip(q) - chain.Tip(q)).norm() < kRoundedText)
      continue;
    throw InputError(
        name +
        ": the corrected geometry cannot be written into this file; write its rows as "
        "[[linkage.joint]] or its axes as [[linkage.axis]], and ball_mm below [linkage]");
  }
}

}  // namespace

std::string WithGeometry(const std::string& text, const WrittenChain& written, const VectorXd& u95,
                         const std::string& name) {
  std::string corrected;
  for (const std::string& line : WithoutGeometry(text)) {
    corrected += line + "\n";
    if (Unindented(line).starts_with("[linkage]")) corrected += GeometryText(written, u95);
  }
  RefuseOther(corrected, written, name);
  return corrected;
}

}  // namespace abbe::relm
