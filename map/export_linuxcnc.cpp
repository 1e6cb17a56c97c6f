#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "failure/failure.h"
#include "map/export_axis_comp.h"
#include "map/text_file.h"
#include "map/words.h"
#include "settings/unit.h"

namespace abbe::map {
namespace {

using settings::kMillimetre;

std::filesystem::path PathOf(const std::filesystem::path& path, int axis) {
  std::filesystem::path file = path;
  file.replace_filename(fmt::format("{}_{}.comp", path.stem().string(), "xyz"[axis]));
  return file;
}

}  // namespace

double AxisCurve::At(double position) const {
  if (position <= positions.front()) return values.front();
  if (position >= positions.back()) return values.back();
  const auto above = std::upper_bound(positions.begin(), positions.end(), position);
  const std::size_t i = above - positions.begin();
  const double part = (position - positions[i - 1]) / (positions[i] - positions[i - 1]);
  return values[i - 1] + part * (values[i] - values[i - 1]);
}

Format::Paths WriteLinuxcnc(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path) {
  const Eigen::Vector3d signs = map.model().chain().ToolSenses();
  const auto& travels = map.model().travels();
  const Eigen::Vector3d middle((travels[0].first + travels[0].last) / 2,
                               (travels[1].first + travels[1].last) / 2,
                               (travels[2].first + travels[2].last) / 2);
  Format::Paths files;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (options.counts[axis] < 2 || options.counts[axis] > kLinuxcncPoints) {
      throw InputError(
          fmt::format("{} points for {}: a .comp of LinuxCNC takes 2 to {}; give fewer "
                      "with --points",
                      options.counts[axis], "XYZ"[axis], kLinuxcncPoints));
    }
    const GridAxis stations{travels[axis].first, travels[axis].last, options.counts[axis]};
    std::string text;
    for (Eigen::Index i = 0; i < stations.count; ++i) {
      Eigen::Vector3d position = middle;
      position[axis] = stations.At(i);
      const double actual = position[axis] + signs[axis] * map.Error(position, options.tool)[axis];
      text += fmt::format("{0:.9f} {1:.9f} {1:.9f}\n", position[axis] / kMillimetre,
                          actual / kMillimetre);
    }
    files.push_back(PathOf(path, axis));
    WriteWhole(text, files.back());
  }
  return files;
}

AxisCurve ReadComp(const std::filesystem::path& file) {
  const std::string text = ReadWhole(file);
  Lines lines(text, file.string());
  AxisCurve curve;
  for (std::string_view line; lines.Next(line);) {
    const auto numbers = NumbersOf(line, lines.Where());
    if (numbers.size() != 3) {
      throw InputError(
          fmt::format("{}: {} numbers; LinuxCNC silently stops reading at a line "
                      "without three",
                      lines.Where(), numbers.size()));
    }
    const double nominal = numbers[0] * kMillimetre;
    if (!curve.positions.empty() && nominal <= curve.positions.back()) {
      throw InputError(lines.Where() + ": the positions must ascend");
    }
    curve.positions.push_back(nominal);
    curve.values.push_back((numbers[1] - numbers[0]) * kMillimetre);
    if (curve.positions.size() > kLinuxcncPoints) {
      throw InputError(fmt::format("{}: more than {} points, which LinuxCNC does not take",
                                   lines.Where(), kLinuxcncPoints));
    }
  }
  if (curve.positions.size() < 2) {
    throw InputError(file.string() + ": contains no table of at least two points");
  }
  return curve;
}

ErrorField ReadBackLinuxcnc(const Format::Paths& files, const machine::Chain& chain) {
  const std::array<AxisCurve, 3> curves = {ReadComp(files.at(0)), ReadComp(files.at(1)),
                                           ReadComp(files.at(2))};
  const Eigen::Vector3d signs = chain.ToolSenses();
  return [curves, signs](const Eigen::Vector3d& p) {
    const Eigen::Vector3d off(curves[0].At(p.x()), curves[1].At(p.y()), curves[2].At(p.z()));
    return Eigen::Vector3d(signs.cwiseProduct(off));
  };
}

}  // namespace abbe::map
