// SPDX-License-Identifier: BSD-3-Clause
// The kernels of laws at points, of one instruction set, as function pointers.
#pragma once

#include <cstdint>

namespace bezsoma {

/// Where the least or greatest of something stands.
struct Extreme {
    double value;
    std::int64_t place; // batch * lanes + lane
    std::int32_t point;
};

/// What a law has seen: the least J and the greatest argument of an exponential.
struct Extremes {
    Extreme least_J, greatest_exponent;
};

/// What a law is asked at `count` points of a batch: states and changes (count, components, lanes),
/// answers alike. Components are the six strains XX YY ZZ XY YZ ZX, shears engineering, or the nine
/// of H row after row; in the mixed form one more, p and what is tested against q.
/// watch (4, lanes): least J, its point, greatest exponent, its point.
template <class T> struct AtPoints {
    std::int32_t count, first; // `first`: number of the first point
    const T *parameters;
    std::int32_t terms; // of laws that are sums
    const T *state, *change;
    T *answer; // energies: (count, lanes)
    T *watch;
};

template <class T> struct LawKernel {
    using At = void (*)(const AtPoints<T> &);
    At stress, derivative, energy;
    At mixed_stress, mixed_derivative, mixed_energy; // empty where the law does not split
    std::int32_t components;
    bool finite, has_energy;
};

/// A quadrature rule, and the polynomials of degree - 1 there: values (points, controls) and
/// tests (controls, points), these times the weights.
template <class T> struct Rule {
    std::int32_t points, controls;
    const T *values, *tests, *weights;
};

/// Tets of one law and region in batches of one per lane: see Batches.
/// geometry (batches, 10, lanes): grad L_i, i = 1..3, and the volume.
template <class T> struct PointwiseBatches {
    std::int64_t count;
    const std::int32_t *first;
    const T *geometry;
    const T *u, *du;
    T *f;
    const LawKernel<T> *law;
    const T *parameters;
    std::int32_t terms;
    const Rule<T> *rule;
    T *scratch; // pointwise_scratch(degree, lanes) numbers
    Extremes *extremes;
};

template <class T> struct PointwiseKernel {
    void (*forces)(const PointwiseBatches<T> &);
    void (*tangent)(const PointwiseBatches<T> &);
    double (*energy)(const PointwiseBatches<T> &);
};

constexpr int number_of_laws = 14;
constexpr std::int32_t points_at_once = 4;

struct PointwiseKernels {
    LawKernel<double> laws[number_of_laws]; // in the order of law.cpp
    PointwiseKernel<double> f64[10];        // by degree - 1
};

} // namespace bezsoma
