#include "relm/model_builder.h"

#include <fmt/format.h>

namespace abbe::relm {

ModelBuilder::ModelBuilder(const LinkageSettings& settings)
    : motions(settings.chain, settings.DownB()) {}

void ModelBuilder::Block(const std::string& name, const estimation::PrintUnit& unit) {
  blocks_.push_back({name, unit, {}});
}

void ModelBuilder::Entry(const std::string& name, double sd, Effect effect) {
  Entry(name, sd, effect, 0.0, 0.0);
}

void ModelBuilder::Entry(const std::string& name, double sd, Effect effect, double nominal,
                         double rest) {
  estimation::Parameter parameter;
  parameter.name = name;
  parameter.nominal = nominal;
  parameter.value = nominal;
  parameter.held = sd == 0;
  if (!parameter.held) parameter.prior_sd = sd;
  blocks_.back().entries.push_back(parameter);
  effect.parameter = motions.Parameter(rest);
  motions.Add(effect);
}

void ModelBuilder::Also(Effect effect) {
  effect.parameter = static_cast<int>(motions.parameters()) - 1;
  motions.Add(effect);
}

void ModelBuilder::HarmonicEntries(const std::string& prefix, double sd, int motion, int joint,
                                   const std::vector<int>& orders) {
  for (const int order : orders) {
    Effect effect{.motion = motion, .joint = joint, .order = order};
    effect.basis = Basis::kSine;
    Entry(fmt::format("{}_sin_{}", prefix, order), sd, effect);
    effect.basis = Basis::kCosine;
    Entry(fmt::format("{}_cos_{}", prefix, order), sd, effect);
  }
}

LinkageModel ModelBuilder::Build(const std::string& name) const {
  std::vector<estimation::ParameterBlock> blocks;
  for (const auto& block : blocks_) {
    if (!block.entries.empty()) blocks.push_back(block);
  }
  return LinkageModel(name, motions, blocks);
}

std::string PivotName(Eigen::Index joint) { return fmt::format("pivot_{}", joint + 1); }

}  // namespace abbe::relm
