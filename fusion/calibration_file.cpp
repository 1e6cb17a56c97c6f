#include "fusion/calibration_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "failure/failure.h"
#include "recording/whole_file.h"
#include "settings/document.h"
#include "settings/toml_text.h"
#include "settings/unit.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using estimation::Parameter;
using estimation::ParameterBlock;
using settings::Float;
using settings::Quoted;
using settings::QuotedList;
using settings::Table;

constexpr std::int64_t kFormat = 1;
constexpr std::array kAxes{"x_mm", "y_mm", "z_mm"};

template <typename Values>
std::string Floats(const Values& values, double si) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const double value : values) texts.push_back(Float(value / si));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string ParameterText(const ParameterBlock& block, std::size_t i) {
  const Parameter& entry = block.entries[i];
  const auto printed = [&](double value) { return Float(value / block.unit.si); };
  const auto line = [&](const char* key, double value) {
    return std::isfinite(value) ? fmt::format("{} = {}\n", key, printed(value)) : std::string();
  };
  return fmt::format(
      "\n[[parameter]]\nname = {}\nunit = {}\nvalue = {}\n{}nominal = {}\n{}held = {}\n",
      Quoted(block.FullName(i)), Quoted(block.unit.name), printed(entry.value),
      line("uncertainty", entry.uncertainty), printed(entry.nominal), line("prior", entry.prior_sd),
      entry.held);
}

std::string MappedText(const MappedParameters& mapped) {
  std::string text = "\n[mapped]\n";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text +=
        fmt::format("{} = {}\n", kAxes[axis], Floats(mapped.centres[axis], settings::kMillimetre));
  }
  for (const auto& values : mapped.values) {
    text += fmt::format("[[mapped.cell]]\nvalues = {}\n", Floats(values, 1.0));
  }
  return text;
}

void ReadParameter(const Table& table, ParameterBlock& block, std::size_t i) {
  const std::string name = table.Text("name");
  if (name != block.FullName(i)) {
    throw table.Error("name", fmt::format("is \"{}\" where this machine file has \"{}\"; calibrate "
                                          "again with this machine file",
                                          name, block.FullName(i)));
  }
  const std::string unit = table.Text("unit");
  if (unit != block.unit.name) {
    throw table.Error("unit", fmt::format("must be \"{}\"", block.unit.name));
  }
  Parameter& entry = block.entries[i];
  const auto number = [&](const char* key) { return table.Number(key) * block.unit.si; };
  const auto number_or_none = [&](const char* key) {
    return table.Has(key) ? number(key) : std::numeric_limits<double>::infinity();
  };
  entry.value = number("value");
  entry.uncertainty = number_or_none("uncertainty");
  entry.nominal = number("nominal");
  entry.prior_sd = number_or_none("prior");
  entry.held = table.Truth("held", false);
  table.RefuseUnknown();
}

void ReadCovariance(const Table& table, Calibration& calibration) {
  calibration.names = table.Texts("names", 0);
  const Index n = calibration.names.size();
  const auto rows = table.Quantities("rows", calibration.names.size() * calibration.names.size());
  calibration.covariance = Eigen::Map<const Eigen::MatrixXd>(rows.data(), n, n);
  table.RefuseUnknown();
}

MappedParameters ReadMapped(const Table& table, Index parameters) {
  MappedParameters mapped;
  std::size_t cells = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    mapped.centres[axis] = table.Quantities(kAxes[axis], 0);
    cells *= mapped.centres[axis].size();
  }
  for (const Table& cell : table.Children("cell")) {
    const auto values = cell.Quantities("values", parameters);
    mapped.values.emplace_back(Eigen::Map<const Eigen::VectorXd>(values.data(), parameters));
    cell.RefuseUnknown();
  }
  if (mapped.values.size() != cells || cells == 0) {
    throw table.Error("cell",
                      fmt::format("has {} cells for {} centres", mapped.values.size(), cells));
  }
  table.RefuseUnknown();
  return mapped;
}

}  // namespace

void WriteCalibration(const Calibration& calibration, const std::filesystem::path& path) {
  std::string text = fmt::format(
      "# A calibration of the linkage, written by abbe calibrate.\nformat = {}\nmachine = {}\n"
      "model = {}\ndisplacement = {}\nmountings = {}\n",
      kFormat, Quoted(calibration.machine), Quoted(relm::ErrorModelName(calibration.model)),
      calibration.displacement, QuotedList(calibration.mountings));
  if (std::isfinite(calibration.held_out_rms)) {
    text += fmt::format("held_out_rms_um = {}\n",
                        Float(calibration.held_out_rms / settings::kMicrometre));
  }
  for (const ParameterBlock& block : calibration.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) text += ParameterText(block, i);
  }
  text += fmt::format("\n[covariance]\nnames = {}\nrows = {}\n", QuotedList(calibration.names),
                      Floats(calibration.covariance.reshaped(), 1.0));
  if (calibration.mapped) text += MappedText(*calibration.mapped);

  recording::WriteWhole(text, path);
}

Calibration ReadCalibration(const std::filesystem::path& path,
                            const relm::LinkageSettings& settings) {
  const auto document = settings::Document::Read(path);
  const Table root = document.Root();
  if (root.Integer("format") != kFormat) {
    throw root.Error("format", "is of another version of abbe; calibrate again");
  }
  Calibration calibration;
  calibration.machine = root.Text("machine");
  calibration.model = relm::ErrorModelNamed(root.Text("model"));
  calibration.displacement = root.Truth("displacement", false);
  calibration.mountings = root.Texts("mountings", 0);
  if (root.Has("held_out_rms_um")) calibration.held_out_rms = root.Quantity("held_out_rms_um");
  for (const std::string& mounting : calibration.mountings) {
    auto base = simulation::BaseBlocks(settings);
    base[0].name = simulation::BaseBlock(mounting);
    base[1].name = simulation::BaseTurnBlock(mounting);
    calibration.blocks.insert(calibration.blocks.end(), base.begin(), base.end());
  }
  const auto model = relm::MakeLinkageModel(settings, calibration.model);
  calibration.blocks.insert(calibration.blocks.end(), model.blocks().begin(), model.blocks().end());
  const auto tables = root.Children("parameter");
  std::size_t at = 0;
  for (ParameterBlock& block : calibration.blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i, ++at) {
      if (at == tables.size()) {
        throw root.Error("parameter", fmt::format("lacks {} of this machine file; calibrate again "
                                                  "with it",
                                                  block.FullName(i)));
      }
      ReadParameter(tables[at], block, i);
    }
  }
  if (at != tables.size()) {
    throw root.Error("parameter", fmt::format("holds {} parameters, this machine file has {}; "
                                              "calibrate again with it",
                                              tables.size(), at));
  }
  ReadCovariance(root.Child("covariance"), calibration);
  if (root.Has("mapped")) {
    calibration.mapped = ReadMapped(root.Child("mapped"), model.parameters());
  }
  root.RefuseUnknown();
  return calibration;
}

}  // namespace abbe::fusion
