#include "report/page_template.h"

#include <cstddef>

// The assembler embeds the file between two symbols: five megabytes cost no compile time.
asm(".pushsection .rodata\n"
    ".global abbe_page_template\n"
    ".global abbe_page_template_end\n"
    "abbe_page_template:\n"
    ".incbin \"" ABBE_PAGE_TEMPLATE
    "\"\n"
    "abbe_page_template_end:\n"
    ".popsection\n");

extern "C" const char abbe_page_template[];
extern "C" const char abbe_page_template_end[];

namespace abbe::report {

std::string_view PageTemplate() {
  return {abbe_page_template,
          static_cast<std::size_t>(abbe_page_template_end - abbe_page_template)};
}

}  // namespace abbe::report
