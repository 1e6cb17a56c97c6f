// One HTML page for an output folder: a section with figures and tables for every result in it.
//
//   const auto report = report::ComposeReport("out");
//   for (const std::string& note : report.notes) fmt::print(stderr, "abbe: {}\n", note);
//
// A result is a file *.json whose top level is an object with a text "command" ("reduce", ...) and,
// if a command has several kinds of result, a text "kind" ("sweep", "reference", ...). The page
// contains the results unchanged and draws them in the browser, without a network: report/page/ has
// one script per kind of section. A kind without a script is shown as a table of its numbers. A
// figure whose keys are absent is left out.
//
// Units: the numbers of a result are SI unless their key says otherwise (docs/report.md); the page
// converts them for display.
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
  // One line for each *.json that is not a result: file, reason and remedy. Also on the page.
  std::vector<std::string> notes;
};

// The results of `folder` (not of folders below it), in the order of their file names, as a page.
// InputError when `folder` is not a folder or has no result.
Report ComposeReport(const std::filesystem::path& folder);

// One file of the folder, as the live page takes it.
struct ResultFile {
  std::string json;  // of a result: one line; empty where it is none
  std::string note;  // why it is none
};
ResultFile ReadResultFile(const std::filesystem::path& file);

// The page without results, which come from the server that it is loaded from. `live`: a JSON object
// for the scripts, in one line (report/page/live.js).
std::string LivePage(const std::filesystem::path& folder, const std::string& live);

}  // namespace abbe::report
