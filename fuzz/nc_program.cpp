// `compensation/nc_correction.h`: what is written can be read again, as moves of the same program.
#include <algorithm>

#include "compensation/nc_correction.h"
#include "fuzz/small_map.h"
#include "fuzz/target.h"

namespace abbe::fuzz::nc_program {

// Every line of `text` with its number.
template <typename Use>
void EachLine(std::string_view text, const Use& use) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    use(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

void Read(Bytes bytes) {
  static const map::ErrorMap map = SmallMap();
  static const compensation::Corrector corrector(map, Eigen::Vector3d(0.0, 0.0, 0.1));
  compensation::NcOptions options;
  options.limits = {.chord = 1e-5, .length = 0.05};
  options.start = Eigen::Vector3d::Constant(0.1);
  compensation::NcCorrection correction(corrector, options);
  std::string out;
  EachLine(TextOf(bytes), [&](std::string_view line, std::size_t) { correction.Take(line, out); });
  std::vector<compensation::NcWord> words;
  EachLine(out, [&](std::string_view line, std::size_t number) {
    compensation::ReadBlock(line, number, words);
  });
}

}  // namespace abbe::fuzz::nc_program
