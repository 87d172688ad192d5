// The random numbers of random.h in Highway's vectors: the same random bits, and normal numbers that differ
// from normal_pair()'s by a few units in the last place.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_BASE_RANDOM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_BASE_RANDOM_INL_H_
#undef PELAGIC_CORE_BASE_RANDOM_INL_H_
#else
#define PELAGIC_CORE_BASE_RANDOM_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <cstdint>

#include "core/base/sincos-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {

// Philox4x32-10 of counters (c0, c1, c2, c3), a word in the lower half of each lane; the upper halves may
// hold anything, before and after.
template <class D64, class U64 = hwy::HWY_NAMESPACE::Vec<D64>>
HWY_INLINE void Philox(D64 d, std::uint64_t key, U64& c0, U64& c1, U64& c2, U64& c3) {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::Repartition<std::uint32_t, D64> words;
    constexpr std::uint32_t kWeyl0 = 0x9E3779B9u, kWeyl1 = 0xBB67AE85u;
    const auto multiplier0 = hn::BitCast(words, hn::Set(d, 0xD2511F53u));
    const auto multiplier1 = hn::BitCast(words, hn::Set(d, 0xCD9E8D57u));
    auto key0 = static_cast<std::uint32_t>(key), key1 = static_cast<std::uint32_t>(key >> 32);
    for (int round = 0; round < 10; ++round) {
        const U64 product0 = hn::MulEven(multiplier0, hn::BitCast(words, c0));
        const U64 product1 = hn::MulEven(multiplier1, hn::BitCast(words, c2));
        c0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(product1), c1), hn::Set(d, std::uint64_t{key0}));
        c2 = hn::Xor(hn::Xor(hn::ShiftRight<32>(product0), c3), hn::Set(d, std::uint64_t{key1}));
        c1 = product1;
        c3 = product0;
        key0 += kWeyl0;
        key1 += kWeyl1;
    }
}

// high·2³² + low, rounded once to a double. Each word is the lower half of its lane.
template <class D, class U64>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> WordsAsDouble(D d, U64 high, U64 low) {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::RebindToUnsigned<D> bits;
    // Exact: a word that replaces the last bits of 2⁵²'s fraction makes the double 2⁵² + word.
    const auto exact = [&](U64 word) HWY_ATTR {
        const auto fraction = hn::And(word, hn::Set(bits, std::uint64_t{0xFFFFFFFF}));
        return hn::Sub(hn::BitCast(d, hn::Or(fraction, hn::Set(bits, std::uint64_t{0x4330000000000000}))),
                       hn::Set(d, 0x1p52));
    };
    return hn::MulAdd(exact(high), hn::Set(d, 0x1p32), exact(low));
}

// normal_pair() of random.h at the counters (c0, c1, c2, c3).
template <class D, class U64>
HWY_INLINE void NormalPairs(D d, std::uint64_t key, U64 c0, U64 c1, U64 c2, U64 c3,
                            hwy::HWY_NAMESPACE::Vec<D>& first, hwy::HWY_NAMESPACE::Vec<D>& second) {
    namespace hn = hwy::HWY_NAMESPACE;
    Philox(hn::RebindToUnsigned<D>(), key, c0, c1, c2, c3);
    const auto one = hn::Set(d, 1.0), unit = hn::Set(d, 0x1p-64);
    const auto u = hn::Min(hn::Mul(hn::Add(WordsAsDouble(d, c0, c1), one), unit), one);  // (0, 1]
    const auto radius = hn::Sqrt(hn::Max(hn::Mul(hn::Set(d, -2.0), hn::Log(d, u)), hn::Zero(d)));
    hn::Vec<D> sine, cosine;
    SinCosCycles(d, hn::Mul(WordsAsDouble(d, c2, c3), unit), sine, cosine);
    first = hn::Mul(radius, cosine);
    second = hn::Mul(radius, sine);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
