// Highway compiles what stands between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each
// width of vectors and takes the widest that the processor has.
#include "random/counter_words.h"

#include <algorithm>

#include "random/counter_random.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "random/counter_words.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::random::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
void Fill(std::uint64_t seed, std::uint64_t stream, std::uint64_t first_counter,
          std::span<std::uint32_t> words) {
  const CounterRandom random(seed, stream);
  for (std::size_t at = 0; at < words.size(); at += 4) {
    std::ranges::copy(random.Bits(first_counter + at / 4), words.begin() + at);
  }
}
#else
// A counter in each number of 64 bits; what stands in the upper halves of the words means nothing, and
// a product takes the lower halves.
void Fill(std::uint64_t seed, std::uint64_t stream, std::uint64_t first_counter,
          std::span<std::uint32_t> words) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<std::uint64_t, kWordsAtOnce / 4> d;
  const hn::Repartition<std::uint32_t, decltype(d)> halves;
  const auto times = [&](auto c, std::uint32_t factor) {
    return hn::MulEven(hn::BitCast(halves, c), hn::Set(halves, factor));
  };
  const auto lower = hn::Set(d, 0xFFFFFFFF), numbers = hn::Iota(d, 0);
  for (std::size_t at = 0; at < words.size(); at += 4 * hn::Lanes(d)) {
    auto c0 = hn::Add(hn::Set(d, first_counter + at / 4), numbers), c1 = hn::ShiftRight<32>(c0);
    auto c2 = hn::Set(d, stream), c3 = hn::Set(d, stream >> 32);
    std::uint32_t k0 = static_cast<std::uint32_t>(seed);
    std::uint32_t k1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < 10; ++round) {
      const auto p0 = times(c0, 0xD2511F53), p1 = times(c2, 0xCD9E8D57);
      c0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p1), c1), hn::Set(d, k0));
      c2 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p0), c3), hn::Set(d, k1));
      c1 = p1;
      c3 = p0;
      k0 += 0x9E3779B9;
      k1 += 0xBB67AE85;
    }
    hn::StoreInterleaved2(hn::Or(hn::And(c0, lower), hn::ShiftLeft<32>(c1)),
                          hn::Or(hn::And(c2, lower), hn::ShiftLeft<32>(c3)), d,
                          reinterpret_cast<std::uint64_t*>(words.data() + at));
  }
}
#endif

}  // namespace abbe::random::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::random {

HWY_EXPORT(Fill);

void FillWords(std::uint64_t seed, std::uint64_t stream, std::uint64_t first_counter,
               std::span<std::uint32_t> words) {
  HWY_DYNAMIC_DISPATCH(Fill)(seed, stream, first_counter, words);
}

}  // namespace abbe::random
#endif  // HWY_ONCE
