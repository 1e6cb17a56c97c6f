// The readers of certificates, `certificate/dcc.h` and `certificate/qif.h`.
#include "certificate/dcc.h"
#include "certificate/qif.h"
#include "fuzz/target.h"

namespace abbe::fuzz::certificate {

void Read(Bytes bytes) {
  const std::string_view text = TextOf(bytes);
  if (text.find("QIFDocument") != std::string_view::npos) {
    abbe::certificate::ReadQif(text, "input");
  } else {
    abbe::certificate::ReadDcc(text, "input");
  }
}

}  // namespace abbe::fuzz::certificate
