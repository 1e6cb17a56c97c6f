#include "estimation/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kMostWeakDirections = 12;

// Position of a parameter: block, entry and column (-1: held).
struct EntryPlace {
  const ParameterBlock* block;
  std::size_t entry;
  Index column;
};

template <class Visitor>
void VisitParameters(const std::vector<ParameterBlock>& blocks, Visitor visit) {
  Index column = 0;
  for (const ParameterBlock& block : blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      visit(EntryPlace{&block, i, block.entries[i].held ? -1 : column});
      column += block.entries[i].held ? 0 : 1;
    }
  }
}

EntryPlace Find(const std::vector<ParameterBlock>& blocks, std::string_view full_name) {
  EntryPlace found{nullptr, 0, -1};
  VisitParameters(blocks, [&](const EntryPlace& place) {
    if (found.block == nullptr && place.block->FullName(place.entry) == full_name) found = place;
  });
  if (found.block == nullptr) {
    throw InputError(fmt::format("the result has no parameter '{}'", full_name));
  }
  return found;
}

const Parameter& Get(const EntryPlace& place) { return place.block->entries[place.entry]; }

std::vector<Index> ColumnsOf(const std::vector<ParameterBlock>& blocks,
                             const ParameterBlock& block) {
  std::vector<Index> columns;
  VisitParameters(blocks, [&](const EntryPlace& place) {
    if (place.block == &block) columns.push_back(place.column);
  });
  return columns;
}

std::string FirstUndetermined(const Result& result) {
  for (const WeakDirection& weak : result.weak_directions) {
    if (weak.held != WeakDirection::Held::kByPrior) return weak.words;
  }
  return "a combination that rounding hides";
}

// `value` with as many decimals as two digits of its uncertainty need.
std::string WithDigitsOf(double value, double uncertainty) {
  if (!(uncertainty > 0.0) || !std::isfinite(uncertainty)) return fmt::format("{:.6g}", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(uncertainty)));
  return decimals > 9 || decimals < -6 ? fmt::format("{:.9g}", value)
                                       : fmt::format("{:.{}f}", value, std::max(0, decimals));
}

void ReportSources(const Result& result, std::string& text) {
  std::size_t width = 6;
  for (const SourceResult& source : result.sources) width = std::max(width, source.name.size());
  auto out = std::back_inserter(text);
  fmt::format_to(out, "  {:<{}}  {:>9}  {:>11}  {:>11}  {:>6}  {:>8}\n", "source", width, "rows",
                 "redundancy", "chi-square", "ratio", "outliers");
  for (const SourceResult& s : result.sources) {
    const double ratio = s.redundancy > 0.5 ? s.chi_square / s.redundancy : 0.0;
    fmt::format_to(out, "  {:<{}}  {:>9}  {:>11.1f}  {:>11.1f}  {:>6}  {:>8}\n", s.name, width,
                   s.rows, s.redundancy, s.chi_square,
                   s.redundancy > 0.5 ? fmt::format("{:.2f}", ratio) : "-", s.outlier_count);
  }
}

void ReportParameters(const Result& result, std::size_t most, std::string& text) {
  std::size_t width = 9, shown = 0, all = 0;
  VisitParameters(result.blocks, [&](const EntryPlace& place) {
    width = std::max(width, place.block->FullName(place.entry).size());
    ++all;
  });
  auto out = std::back_inserter(text);
  fmt::format_to(out, "  {:<{}}  {:>14}  {:>10}  {:<6}  {}\n", "parameter", width, "value", "u",
                 "unit", "seen by");
  VisitParameters(result.blocks, [&](const EntryPlace& place) {
    if (++shown > most) return;
    const Parameter& p = Get(place);
    const PrintUnit& unit = place.block->unit;
    const double u = p.uncertainty / unit.si;
    const SeenBy seen = place.column < 0 ? SeenBy::kHeld : result.seen_by[place.column];
    fmt::format_to(out, "  {:<{}}  {:>14}  {:>10.2g}  {:<6}  {}\n",
                   place.block->FullName(place.entry), width, WithDigitsOf(p.value / unit.si, u), u,
                   unit.name, Name(seen));
  });
  if (all > most) fmt::format_to(out, "  ... and {} parameters more\n", all - most);
}

std::string Standing(const WeakDirection& weak) {
  switch (weak.held) {
    case WeakDirection::Held::kByPrior:
      return fmt::format("stays at {:.2f} of its prior", weak.ratio);
    case WeakDirection::Held::kByTolerance:
      return "not determined to its tolerance";
    case WeakDirection::Held::kByNothing:
      break;
  }
  return "not determined at all";
}

void ReportWeakDirections(const Result& result, std::string& text) {
  auto out = std::back_inserter(text);
  const std::size_t count = result.weak_directions.size();
  if (count == 0) {
    text += "  the data see every combination of the parameters\n";
    return;
  }
  fmt::format_to(
      out,
      "  not seen by the data: {} of {} combinations (in units of each parameter's prior "
      "or tolerance)\n",
      count, result.names.size());
  for (std::size_t i = 0; i < std::min(count, kMostWeakDirections); ++i) {
    const WeakDirection& weak = result.weak_directions[i];
    fmt::format_to(out, "    {}: {}\n", weak.words, Standing(weak));
  }
  if (count > kMostWeakDirections) {
    fmt::format_to(out, "    ... and {} more\n", count - kMostWeakDirections);
  }
}

}  // namespace

std::string_view Name(SeenBy seen) {
  switch (seen) {
    case SeenBy::kHeld:
      return "held";
    case SeenBy::kData:
      return "data";
    case SeenBy::kPrior:
      return "prior";
    case SeenBy::kNothing:
      break;
  }
  return "nothing";
}

std::string Result::WhyNotUsable() const {
  if (status == Status::kNotRun) return "the fit was not run; call Solve first";
  if (status == Status::kConverged) return "";
  return fmt::format(
      "neither data nor priors determine {}; add measurements that move it, state a prior, or hold "
      "a parameter",
      FirstUndetermined(*this));
}

const ParameterBlock& Result::Block(std::string_view block) const {
  for (const ParameterBlock& candidate : blocks) {
    if (candidate.name == block) return candidate;
  }
  throw InputError(fmt::format("the result has no parameter block '{}'", block));
}

double Result::Value(std::string_view full_name) const {
  return Get(Find(blocks, full_name)).value;
}

double Result::Uncertainty(std::string_view full_name) const {
  return Get(Find(blocks, full_name)).uncertainty;
}

SeenBy Result::Seen(std::string_view full_name) const {
  const Index column = Find(blocks, full_name).column;
  return column < 0 ? SeenBy::kHeld : seen_by[column];
}

const SourceResult& Result::Source(std::string_view source) const {
  for (const SourceResult& candidate : sources) {
    if (candidate.name == source) return candidate;
  }
  throw InputError(fmt::format("the result has no source '{}'", source));
}

MatrixXd Result::Covariance(std::string_view block_a, std::string_view block_b) const {
  const std::vector<Index> down = ColumnsOf(blocks, Block(block_a));
  const std::vector<Index> across = ColumnsOf(blocks, Block(block_b));
  MatrixXd out = MatrixXd::Zero(down.size(), across.size());
  for (std::size_t i = 0; i < down.size(); ++i) {
    for (std::size_t j = 0; j < across.size(); ++j) {
      if (down[i] < 0 || across[j] < 0) continue;
      out(i, j) = covariance(down[i], across[j]);
    }
  }
  return out;
}

double Result::Correlation(std::string_view full_name_a, std::string_view full_name_b) const {
  const Index a = Find(blocks, full_name_a).column;
  const Index b = Find(blocks, full_name_b).column;
  if (a < 0 || b < 0) return 0.0;
  return covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
}

std::string Result::Report(std::size_t most_parameters) const {
  if (status == Status::kNotRun) return WhyNotUsable() + "\n";
  std::string text = fmt::format(
      "fit: {} in {} iterations; {} rows, {} free parameters, redundancy of the data {:.1f}\n",
      Usable() ? "converged" : "not usable", iterations, rows, names.size(), redundancy);
  fmt::format_to(std::back_inserter(text),
                 "  chi-square {:.1f} with {} degrees of freedom; condition of the scaled Jacobian "
                 "{:.3g}\n",
                 chi_square, freedom, condition);
  if (!Usable()) text += "  " + WhyNotUsable() + "\n";
  ReportSources(*this, text);
  ReportParameters(*this, most_parameters, text);
  ReportWeakDirections(*this, text);
  return text;
}

}  // namespace abbe::estimation
