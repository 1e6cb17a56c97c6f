// One HTML page of an output folder: every result in it as a section with its figures and tables.
//
//   const auto report = report::ComposeReport("out");
//   for (const std::string& note : report.notes) fmt::print(stderr, "abbe: {}\n", note);
//
// A result is a file *.json whose top is an object with a text "command" ("reduce", ...) and, where
// a command has several kinds of result, a text "kind" ("sweep", "reference", ...). The page holds
// the results as they are and draws them in the browser, without a network: report/page/ has one
// script a kind of section. A kind that no script knows is shown as a table of its numbers. Keys
// that are absent leave out their figure.
//
// Units: the numbers of a result are SI unless their key says otherwise (docs/report.md); the page
// converts them for reading.
//
// Validity: the page is about 5 MB (Plotly) plus the results, which the browser keeps in memory;
// meant for results (thousands of numbers), not for recordings (millions).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "failure/failure.h"

namespace abbe::report {

struct Report {
  std::string page;  // the whole HTML
  std::size_t results = 0;
  // One line for each *.json that is not a result: which file, why, and what to do. The page has
  // them too.
  std::vector<std::string> notes;
};

// The results of `folder` (not of folders below it), in the order of their file names, as a page.
// InputError when `folder` is not a folder or holds no result.
Report ComposeReport(const std::filesystem::path& folder);

}  // namespace abbe::report
