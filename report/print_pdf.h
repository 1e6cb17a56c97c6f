// A report page as PDF, by the print path of a browser (Chromium, headless).
//
//   const std::string pdf = PrintPdf("out/report.html");
//
// Looked for in PATH: chromium, chromium-browser, google-chrome, google-chrome-stable. The page
// needs no network, and gets none of the user's settings: the browser runs in a folder of its own.
//
// Failure: InputError when there is no browser, or when it does not print the page, with the first
// line that says why. Validity: the paper is what the style sheet of the page asks for.
#pragma once

#include <filesystem>
#include <string>

#include "failure/failure.h"

namespace abbe::report {

// The bytes of the PDF.
std::string PrintPdf(const std::filesystem::path& page);

}  // namespace abbe::report
