// The entry of libFuzzer, compiled once for each target.
#include "fuzz/contract.h"

namespace abbe::fuzz::ABBE_FUZZ_TARGET {
void Read(Bytes bytes);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  abbe::fuzz::HoldContract(abbe::fuzz::ABBE_FUZZ_TARGET::Read, {data, size});
  return 0;
}
