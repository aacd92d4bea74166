// SPDX-License-Identifier: BSD-3-Clause
// Numbers with their change in one direction: a law written once for numbers gives its derivative.
#pragma once

#include "lane_functions.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// v + d t with t^2 = 0.
template <class R> struct Dual {
    R v, d;
    BEZSOMA_INLINE Dual &operator+=(const Dual &b) { return *this = *this + b; }
};

template <class S> struct ScalarOf {
    using Type = Scalar<S>;
};
template <class R> struct ScalarOf<Dual<R>> {
    using Type = Scalar<R>;
};
/// The plain number behind lanes or dual numbers.
template <class S> using Plain = typename ScalarOf<S>::Type;

#define BEZSOMA_DUAL template <class R> BEZSOMA_INLINE Dual<R>
BEZSOMA_DUAL operator-(const Dual<R> &a) { return {-a.v, -a.d}; }
BEZSOMA_DUAL operator+(const Dual<R> &a, const Dual<R> &b) { return {a.v + b.v, a.d + b.d}; }
BEZSOMA_DUAL operator-(const Dual<R> &a, const Dual<R> &b) { return {a.v - b.v, a.d - b.d}; }
BEZSOMA_DUAL operator*(const Dual<R> &a, const Dual<R> &b) {
    return {a.v * b.v, a.v * b.d + a.d * b.v};
}
BEZSOMA_DUAL operator+(const Dual<R> &a, Scalar<R> b) { return {a.v + b, a.d}; }
BEZSOMA_DUAL operator+(Scalar<R> a, const Dual<R> &b) { return {a + b.v, b.d}; }
BEZSOMA_DUAL operator-(const Dual<R> &a, Scalar<R> b) { return {a.v - b, a.d}; }
BEZSOMA_DUAL operator*(const Dual<R> &a, Scalar<R> b) { return {a.v * b, a.d * b}; }
BEZSOMA_DUAL operator*(Scalar<R> a, const Dual<R> &b) { return {a * b.v, a * b.d}; }
BEZSOMA_DUAL reciprocal(const Dual<R> &a) {
    const R r = 1 / a.v;
    return {r, -a.d * (r * r)};
}
BEZSOMA_DUAL exp(const Dual<R> &a) {
    const R e = exp(a.v);
    return {e, e * a.d};
}
/// At zero, where |a| has a kink, the change is taken for zero: the mean of both sides.
BEZSOMA_DUAL abs(const Dual<R> &a) { return {abs(a.v), a.v < 0 ? -a.d : a.v > 0 ? a.d : R{}}; }
#undef BEZSOMA_DUAL

template <class R> BEZSOMA_INLINE R reciprocal(const R &a) { return 1 / a; }
/// The number without its change.
template <class R> BEZSOMA_INLINE R value(const Dual<R> &a) { return a.v; }
template <class R> BEZSOMA_INLINE R value(const R &a) { return a; }

} // namespace bezsoma::BEZSOMA_ISA
