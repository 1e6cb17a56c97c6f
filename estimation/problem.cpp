#include "estimation/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

void CheckEntry(const ParameterBlock& block, std::size_t i) {
  const Parameter& entry = block.entries[i];
  const std::string name = block.FullName(i);
  if (entry.name.empty()) {
    throw InputError(fmt::format("parameter block '{}': entry {} has no name", block.name, i));
  }
  if (!std::isfinite(entry.nominal) || !std::isfinite(entry.value)) {
    throw InputError(fmt::format("parameter {}: nominal {} and start {} must be finite", name,
                                 entry.nominal, entry.value));
  }
  if (!(entry.prior_sd > 0.0) || !(entry.tolerance > 0.0)) {
    throw InputError(
        fmt::format("parameter {}: prior deviation {} and tolerance {} must be above 0; to fix a "
                    "value, hold it",
                    name, entry.prior_sd, entry.tolerance));
  }
}

void CheckBlock(const ParameterBlock& block, const std::vector<ParameterBlock>& known) {
  if (block.name.empty() || block.entries.empty()) {
    throw InputError(
        fmt::format("parameter block '{}' needs a name and at least one parameter", block.name));
  }
  for (const ParameterBlock& other : known) {
    if (other.name == block.name) {
      throw InputError(
          fmt::format("parameter block '{}' is there already; names must differ", block.name));
    }
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < block.entries.size(); ++i) {
    CheckEntry(block, i);
    if (!names.insert(block.entries[i].name).second) {
      throw InputError(fmt::format("parameter {} is there twice in its block", block.FullName(i)));
    }
  }
}

}  // namespace

BlockId Problem::Add(ParameterBlock block) {
  CheckBlock(block, blocks_);
  first_entry_.push_back(
      blocks_.empty() ? 0 : first_entry_.back() + static_cast<int>(blocks_.back().size()));
  blocks_.push_back(std::move(block));
  return {static_cast<int>(blocks_.size()) - 1};
}

SourceId Problem::AddSource(std::string name, const SourceOptions& options) {
  const bool taken = std::any_of(sources_.begin(), sources_.end(),
                                 [&](const Source& source) { return source.name == name; });
  if (taken || name.empty() || name == kPriorSource) {
    throw InputError(fmt::format(
        "source '{}': names must differ, must not be empty and not be '{}', which the parameters' "
        "own priors have",
        name, kPriorSource));
  }
  sources_.push_back({std::move(name), options, 0});
  return {static_cast<int>(sources_.size()) - 1};
}

std::vector<int> Problem::EntriesOf(const std::vector<Input>& inputs) const {
  std::vector<int> entries;
  for (const Input& input : inputs) {
    const ParameterBlock& block = blocks_.at(input.block.index);
    const int size = static_cast<int>(block.size());
    const int count = input.count < 0 ? size - input.first : input.count;
    if (input.first < 0 || count < 1 || input.first + count > size) {
      throw InputError(fmt::format("residual: entries {} to {} of block '{}', which has {}",
                                   input.first, input.first + count - 1, block.name, size));
    }
    const int start = first_entry_[input.block.index] + input.first;
    for (int i = 0; i < count; ++i) entries.push_back(start + i);
  }
  std::vector<int> sorted = entries;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
    throw InputError("residual: the same parameter is named twice among its inputs");
  }
  return entries;
}

void Problem::Add(SourceId source, std::shared_ptr<const Residual> residual,
                  const std::vector<Input>& inputs, double standard_deviation) {
  Add(source, std::move(residual), inputs, Eigen::VectorXd::Constant(1, standard_deviation));
}

void Problem::Add(SourceId source, std::shared_ptr<const Residual> residual,
                  const std::vector<Input>& inputs, Eigen::VectorXd standard_deviations) {
  Source& group = sources_.at(source.index);
  const Eigen::Index rows = residual->Rows();
  if (rows < 1 || (standard_deviations.size() != rows && standard_deviations.size() != 1)) {
    throw InputError(
        fmt::format("source '{}': a residual of {} rows with {} standard deviations; give one each",
                    group.name, rows, standard_deviations.size()));
  }
  for (Eigen::Index i = 0; i < standard_deviations.size(); ++i) {
    if (!(standard_deviations[i] > 0.0) || !std::isfinite(standard_deviations[i])) {
      throw InputError(fmt::format("source '{}', row {}: standard deviation {} must be above 0",
                                   group.name, group.rows + i, standard_deviations[i]));
    }
  }
  terms_.push_back(
      {source, std::move(residual), EntriesOf(inputs), std::move(standard_deviations), group.rows});
  group.rows += rows;
}

BlockId Problem::Find(const std::string& block) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].name == block) return {static_cast<int>(i)};
  }
  throw InputError(fmt::format("the problem has no parameter block '{}'", block));
}

}  // namespace abbe::estimation
