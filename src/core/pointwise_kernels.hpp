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

/// Controls that the four permutations of rule.hpp exchange: 4, 2 or 1 of them; control[j] is where
/// permutation j takes the first. sum[k]: the place of their sum with character k, -1 for none.
struct ControlOrbit {
    std::int32_t controls, control[4], sum[4];
};

/// A quadrature rule, four points after four that the permutations exchange, then the others; and
/// the polynomials of degree - 1 there in the basis of rule.hpp: values (points, controls) and
/// tests (controls, points), these times the weights. Character k has begin[k] .. begin[k + 1].
template <class T> struct Rule {
    std::int32_t points, controls, fours, orbits;
    const ControlOrbit *orbit;
    std::int32_t begin[5];
    const T *values, *tests, *weights;
};

/// What depends on the degree of a net. `open` reads displacements of a batch and writes gradient
/// controls (controls, row, lanes): strains [0] or H [1]; `close` takes moments of that layout and
/// adds forces. Those of the pressure work on the last component of each row, elevated to the same
/// degree; empty where there is no mixed form.
template <class T> struct NetKernel {
    void (*open[2])(const T *u, const std::int32_t *first, const T *geometry, T *to, int row);
    void (*close[2])(const T *from, const std::int32_t *first, const T *geometry, T *f, int row);
    void (*open_pressure)(int degree, const T *p, const std::int32_t *first, T *to, int row);
    void (*close_pressure)(int degree, const T *from, const std::int32_t *first, const T *geometry,
                           T *g, int row);
    int entities;
};

/// Tets of one law and region in batches of one per lane: see Batches. Without a pressure, p, dp, g
/// and first_pressure are empty; without a tangent, du and dp.
/// geometry (batches, 10, lanes): grad L_i, i = 1..3, and the volume.
template <class T> struct PointwiseBatches {
    std::int64_t count;
    const NetKernel<T> *net;
    const std::int32_t *first, *first_pressure;
    int pressure_degree, entities_of_pressure;
    const T *geometry;
    const T *u, *du, *p, *dp;
    T *f, *g;
    const LawKernel<T> *law;
    const T *parameters;
    std::int32_t terms;
    Rule<T> rule;
    T *scratch; // scratch_of_pointwise numbers
    Extremes extremes;
};

template <class T> using OnBatches = double (*)(PointwiseBatches<T> &);

constexpr std::int32_t points_at_once = 8;

/// Numbers that a batch needs beside its fields.
constexpr std::int64_t scratch_of_pointwise(std::int64_t controls, std::int64_t lanes) {
    return lanes * (10 * (4 * controls + 3 * points_at_once) + 4);
}

constexpr int number_of_laws = 14;

/// In float32 tangents alone, without a pressure.
struct PointwiseKernels {
    OnBatches<double> forces, tangent, energy; // the last returns the sum of it, others zero
    OnBatches<float> single_tangent;
    NetKernel<double> nets[10]; // by degree - 1
    NetKernel<float> single_nets[10];
    LawKernel<double> laws[number_of_laws]; // in the order of law.cpp
    LawKernel<float> single_laws[number_of_laws];
};

} // namespace bezsoma
