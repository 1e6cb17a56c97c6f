#include "learned/carried.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>

#include "failure/failure.h"
#include "settings/document.h"
#include "settings/toml_text.h"
#include "simulation/causes/registry.h"

namespace abbe::learned {
namespace {

using settings::Document;
using settings::Table;
using simulation::LearnedTerm;
using simulation::ReadLearnedTerm;

constexpr const char* kTable = "[[learned]]";
constexpr double kByChance = 0.05;  // as learning.h

std::vector<Table> TermsOf(const Document& document) {
  const Table root = document.Root();
  if (!root.Has("extended_model")) {
    throw root.Error("",
                     "is no extended model, which begins with extended_model = 1; abbe diagnose "
                     "--learn -o writes one");
  }
  std::vector<Table> terms = root.Children("learned");
  if (terms.empty()) {
    throw root.Error("learned",
                     "has no learned term; abbe diagnose --learn -o writes those that it "
                     "finds");
  }
  return terms;
}

void RefuseNameOfACause(const std::string& name, const std::string& where) {
  for (const simulation::Cause& cause : simulation::Causes()) {
    if (cause.id != name) continue;
    throw InputError(
        fmt::format("{}: \"{}\" is a known cause; give the term another name", where, name));
  }
}

// Whether a line sets a key.
bool Sets(const std::string& line, const std::string& key) {
  if (!line.starts_with(key)) return false;
  const std::size_t next = line.find_first_not_of(" \t", key.size());
  return next != std::string::npos && line[next] == '=';
}

// From 0.
std::size_t TermNumbered(const std::vector<Table>& terms, const std::string& term,
                         const std::string& file) {
  const bool is_number = std::ranges::all_of(term, [](unsigned char c) { return std::isdigit(c); });
  std::string known;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const std::string expression = terms[i].Text("expression");
    if (is_number ? std::to_string(i + 1) == term
                  : expression == term || terms[i].Text("name", "") == term) {
      return i;
    }
    known += fmt::format("{}{}: {} in {}", i == 0 ? "" : ", ", i + 1, expression,
                         terms[i].Text("object"));
  }
  throw InputError(fmt::format("{}: has no learned term \"{}\"; it has {}", file, term, known));
}

}  // namespace

std::vector<std::shared_ptr<const simulation::LearnedCause>> CarriedFrom(
    const std::vector<std::filesystem::path>& files) {
  std::vector<std::shared_ptr<const simulation::LearnedCause>> carried;
  for (const auto& file : files) {
    const Document document = Document::Read(file);
    for (const Table& table : TermsOf(document)) {
      LearnedTerm term = ReadLearnedTerm(table);
      if (!(term.certificate.by_chance < kByChance)) {
        throw table.Error("certificate",
                          "says that chance makes as much, or is missing; only a "
                          "term that was certified is carried on");
      }
      RefuseNameOfACause(term.name, file.string());
      carried.push_back(simulation::LearnedCause::CarriedOn(std::move(term)));
      const auto& last = *carried.back();
      const auto same = [&](const auto& other) {
        return other->cause().id == last.cause().id && other->object() == last.object();
      };
      if (std::any_of(carried.begin(), carried.end() - 1, same)) {
        throw table.Error("name", fmt::format("a second term \"{}\" of {}; give it another name "
                                              "with abbe learned name",
                                              last.cause().id, last.object().name()));
      }
    }
  }
  return carried;
}

std::string WithName(const std::string& text, const std::string& file, const std::string& term,
                     const Naming& naming) {
  RefuseNameOfACause(naming.name, file);
  const Document before = Document::Parse(text, file);
  const std::size_t wanted = TermNumbered(TermsOf(before), term, file);
  std::string named;
  std::size_t table = 0;
  bool is_in = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) is_in = false;
    const bool replaced =
        is_in && (Sets(line, "name") || (Sets(line, "words") && !naming.words.empty()));
    if (!replaced) named += line + "\n";
    if (!line.starts_with(kTable) || table++ != wanted) continue;
    is_in = true;
    named += fmt::format("name = {}\n", settings::Quoted(naming.name));
    if (!naming.words.empty()) named += fmt::format("words = {}\n", settings::Quoted(naming.words));
  }
  // A file that is written otherwise than abbe does it is refused, not broken.
  const Document after = Document::Parse(named, file);
  const auto terms = TermsOf(after);
  if (ReadLearnedTerm(terms.at(wanted)).name != naming.name) {
    throw InputError(
        fmt::format("{}: the table of the term could not be changed; write name = {} "
                    "into it by hand",
                    file, settings::Quoted(naming.name)));
  }
  return named;
}

}  // namespace abbe::learned
