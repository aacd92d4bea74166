// SPDX-License-Identifier: BSD-3-Clause
// exp, log and their like on lanes: no library call, the same in every lane, to the last digits.
#pragma once

#include "../elastic_kernel.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// The number of which R holds several, and integers of the same size.
template <class T> struct Value;
template <class T> struct Value<T &> {
    using Type = T;
};
template <class R> struct Element {
    R lanes;
    using Type = typename Value<decltype((lanes[0]))>::Type;
};
template <class R> using Scalar = typename Element<R>::Type;
template <class T> struct Integers;
template <> struct Integers<double> {
    typedef long long Int;
    static constexpr int mantissa = 52;
    static constexpr double magic = 6755399441055744.0; // 1.5 2^52: adding it rounds to integers
    static constexpr double ln2_high = 6.93147180369123816490e-01,
                            ln2_low = 1.90821492927058770e-10;
    static constexpr double least = -708, greatest = 709;
    static constexpr int exp_terms = 13, log_terms = 10, root_steps = 4;
    static constexpr Int root_magic = 0x5fe6eb50c7b537a9; // C. Lomont 2003
    static constexpr Int cube_magic = 0x553ef0ff289dd796;
    static constexpr int cube_steps = 3;
};
template <> struct Integers<float> {
    typedef int Int;
    static constexpr int mantissa = 23;
    static constexpr float magic = 12582912.0f;
    static constexpr float ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
    static constexpr float least = -87, greatest = 88;
    static constexpr int exp_terms = 7, log_terms = 5, root_steps = 3;
    static constexpr Int root_magic = 0x5f375a86;
    static constexpr Int cube_magic = 0x54a21d2a;
    static constexpr int cube_steps = 2;
};

template <class R> struct Bits {
    using T = Scalar<R>;
    typedef typename Integers<T>::Int Int __attribute__((vector_size(sizeof(R))));
};

static constexpr double inverse_factorial(int n) {
    double f = 1;
    for (int i = 2; i <= n; ++i)
        f /= i;
    return f;
}

/// 1/first! + x/(first + 2)! + x^2/(first + 4)! ..., to last!. Even and odd terms of a series are
/// summed each for itself: half as many steps wait for each other.
template <int first, int last, class R> BEZSOMA_INLINE R exponential_tail(const R &x) {
    constexpr auto here = static_cast<Scalar<R>>(inverse_factorial(first));
    if constexpr (first + 2 > last)
        return R{} + here;
    else
        return exponential_tail<first + 2, last>(x) * x + here;
}

/// exp(x) = 2^k (1 + tail) with |tail| < 0.42: the parts of which exp and exp - 1 are made.
template <class R> struct Exponential {
    R power, tail;
};

template <class R> BEZSOMA_INLINE Exponential<R> exponential(R x) {
    using I = Integers<Scalar<R>>;
    using Int = typename Bits<R>::Int;
    x = x < I::least ? R{} + I::least : x;
    x = x > I::greatest ? R{} + I::greatest : x;
    const R shifted = x * static_cast<Scalar<R>>(1.44269504088896340736) + I::magic;
    const R k = shifted - I::magic;
    const R r = (x - k * I::ln2_high) - k * I::ln2_low;
    const R one = R{} + 1;
    // The low bits of `shifted` are k; above them stands what the shift drops.
    const Int power = (Int)one + ((Int)shifted << I::mantissa);
    const R rr = r * r;
    return {(R)power,
            r * exponential_tail<1, I::exp_terms>(rr) + rr * exponential_tail<2, I::exp_terms>(rr)};
}

/// exp(x); beyond the range of numbers what it is at its end.
template <class R> BEZSOMA_INLINE R exp(const R &x) {
    const Exponential<R> e = exponential(x);
    return e.power + e.power * e.tail;
}

/// exp(x) - 1 without loss near zero.
template <class R> BEZSOMA_INLINE R expm1(const R &x) {
    const Exponential<R> e = exponential(x);
    return e.power * e.tail + (e.power - 1);
}

/// (exp(x) - 1) / x, 1 at zero.
template <class R> BEZSOMA_INLINE R expm1_quotient(const R &x) {
    const R small = x * x < static_cast<Scalar<R>>(1e-40) ? R{} + 1 : x;
    const R found = expm1(small) / small;
    return x * x < static_cast<Scalar<R>>(1e-40) ? R{} + 1 : found;
}

/// 2/(2i+1) + 2 x/(2i+5) + 2 x^2/(2i+9) ...: every second term of 2 (s + s^3/3 + s^5/5 ...), the
/// logarithm of (1 + s) / (1 - s), for x = s^4.
template <int i, int terms, class R> BEZSOMA_INLINE R log_tail(const R &x) {
    constexpr auto here = static_cast<Scalar<R>>(2.0 / (2 * i + 1));
    if constexpr (i + 2 > terms)
        return R{} + here;
    else
        return log_tail<i + 2, terms>(x) * x + here;
}

/// log(1 + x) without loss near zero, for x > -1; for others a number without meaning.
template <class R> BEZSOMA_INLINE R log1p(const R &x) {
    using I = Integers<Scalar<R>>;
    using Int = typename Bits<R>::Int;
    const R one = R{} + 1, u = one + x, half = R{} + static_cast<Scalar<R>>(0.70710678118654752440);
    // u = 2^k m with m from sqrt(1/2) to sqrt(2); shifted right arithmetically.
    const Int k = ((Int)u - (Int)half) >> I::mantissa;
    const R m = (R)((Int)u - (k << I::mantissa));
    const R magic = R{} + I::magic;
    const R exponent = (R)((Int)magic + k) - magic;
    const R above = k == 0 ? x : m - 1;
    const R s = above / (above + 2);
    const R ss = s * s, ssss = ss * ss;
    const R log = s * (log_tail<0, I::log_terms>(ssss) + ss * log_tail<1, I::log_terms>(ssss));
    return log + exponent * I::ln2_low + exponent * I::ln2_high;
}

/// 1/sqrt(x) for normal x > 0. Half the bits of a number are near those of a guess (of -1/2 its
/// logarithm), and Newton's steps double its digits: sooner done than a root and a division.
template <class R> BEZSOMA_INLINE R reciprocal_root(const R &x) {
    using I = Integers<Scalar<R>>;
    using Int = typename Bits<R>::Int;
    R root = (R)(I::root_magic - ((Int)x >> 1));
    const R half = x * static_cast<Scalar<R>>(0.5);
    for (int i = 0; i < I::root_steps; ++i)
        root = root + root * (static_cast<Scalar<R>>(0.5) - half * root * root);
    return root;
}

/// x^(-1/3) for normal x > 0, alike: of -1/3 its logarithm, and steps that treble its digits.
template <class R> BEZSOMA_INLINE R reciprocal_cube_root(const R &x) {
    using I = Integers<Scalar<R>>;
    using Int = typename Bits<R>::Int;
    const Int i = (Int)x, two = (i >> 2) + (i >> 4); // i/3 = i/4 + i/16 + i/64 + ...
    const Int four = two + (two >> 4);
    R root = (R)(I::cube_magic - (four + (four >> 8)));
    for (int step = 0; step < I::cube_steps; ++step) {
        const R left = 1 - (x * root) * (root * root);
        root += (root * left) *
                (left * static_cast<Scalar<R>>(2.0 / 9) + static_cast<Scalar<R>>(1.0 / 3));
    }
    return root;
}

template <class R> BEZSOMA_INLINE R abs(const R &x) { return x < 0 ? -x : x; }
template <class R> BEZSOMA_INLINE R greater(const R &x, const R &y) { return x > y ? x : y; }

} // namespace bezsoma::BEZSOMA_ISA
