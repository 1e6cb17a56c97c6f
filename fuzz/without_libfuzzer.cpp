// A program of one target that reads nothing: that it links shows that the target has all its readers.
#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main() { return LLVMFuzzerTestOneInput(nullptr, 0); }
