// SPDX-License-Identifier: BSD-3-Clause
// Registers of one instruction set, which what is compiled for it works with.
#pragma once

#ifndef BEZSOMA_ISA
#error "BEZSOMA_ISA names the namespace of one instruction set"
#endif

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace bezsoma::BEZSOMA_ISA {

// Also for lambdas: left to itself the compiler stops inlining as the degrees add up.
#define BEZSOMA_INLINED __attribute__((always_inline))
#define BEZSOMA_INLINE inline BEZSOMA_INLINED

/// `lanes` numbers in a register (Lanes) and anywhere in memory (Loose).
template <class T, int lanes> struct Simd {
    typedef T Lanes __attribute__((vector_size(lanes * sizeof(T))));
    typedef T Loose __attribute__((vector_size(lanes * sizeof(T)), aligned(sizeof(T)), may_alias));
};

template <class T, int lanes> using Lanes = typename Simd<T, lanes>::Lanes;

template <class T, int lanes> BEZSOMA_INLINE Lanes<T, lanes> load(const T *from) {
    return *reinterpret_cast<const typename Simd<T, lanes>::Loose *>(from);
}

/// Four numbers and four others beside each other.
BEZSOMA_INLINE Lanes<double, 8> load_halves(const double *low, const double *high) {
#if defined(__AVX512F__) // a load that inserts, where GCC would make two loads and a shuffle
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high),
                              1);
#else // for builds of that width on any processor (BEZSOMA_ONE_SET)
    return __builtin_shufflevector(load<double, 4>(low), load<double, 4>(high), 0, 1, 2, 3, 4, 5, 6,
                                   7);
#endif
}

template <class T, int lanes> BEZSOMA_INLINE void store(T *to, Lanes<T, lanes> v) {
    *reinterpret_cast<typename Simd<T, lanes>::Loose *>(to) = v;
}

/// Half of a register's numbers.
template <class T, int lanes, bool upper>
BEZSOMA_INLINE Lanes<T, lanes / 2> half(Lanes<T, lanes> v) {
    constexpr int b = upper ? lanes / 2 : 0;
    if constexpr (lanes == 4)
        return __builtin_shufflevector(v, v, b, b + 1);
    else
        return __builtin_shufflevector(v, v, b, b + 1, b + 2, b + 3);
}

/// Adds the first `many` numbers of a register to memory and touches no others. In parts that are
/// read as they were stored: after a store under a mask a read waits until it is done.
template <class T, int lanes> BEZSOMA_INLINE void add_first(T *to, Lanes<T, lanes> v, int many) {
    if constexpr (lanes == 2) {
        if (many > 0)
            to[0] += v[0];
        if (many > 1)
            to[1] += v[1];
    } else if (constexpr int part = lanes / 2; many >= part) {
        store<T, part>(to, load<T, part>(to) + half<T, lanes, false>(v));
        add_first<T, part>(to + part, half<T, lanes, true>(v), many - part);
    } else {
        add_first<T, part>(to, half<T, lanes, false>(v), many);
    }
}

} // namespace bezsoma::BEZSOMA_ISA
