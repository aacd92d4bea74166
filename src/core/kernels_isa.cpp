// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, with BEZSOMA_ISA naming it and BEZSOMA_BYTES the width
// of its registers. Nothing of the standard library is included: an inline function of it compiled
// here for a wide processor could be the copy that the linker keeps for all.
#include "kernels.hpp"

#include "elastic_kernel.hpp"

#include "block_kernel.hpp"

#include "formed_shapes.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// From degree 3 on tets share less, and runs are longer than a control: to bring them into an area
/// takes 3 to 20 % more than it saves.
template <int n, int lanes> constexpr bool in_area = n <= 2 && lanes >= 4;

/// Where a run begins in rows of 3 numbers a side.
template <int n, int lanes> BEZSOMA_INLINE std::int64_t run(std::int32_t first, int sides = 1) {
    static_assert(row_of_area == 1 << 3);
    const std::int64_t begin = first;
    return in_area<n, lanes> ? (begin >> 3) * (3 * sides) : begin * sides;
}

/// In place of what is kept: det grad L_i, i = 1..3, and the material over 6 |det|, which is V over
/// the square of det. No root is needed, and one division.
template <class T, int lanes>
BEZSOMA_INLINE void form_shapes(const T *points, const std::int32_t *first, Batch<T, lanes> &tet) {
    using R = Lanes<T, lanes>;
    R x[12], edge[3][3];
    const auto begin_of = [&](int at) BEZSOMA_INLINED { return points + run<1, lanes>(first[at]); };
    gather<1, T, lanes>(begin_of, x);
    for (int k = 0; k < 9; ++k)
        edge[k / 3][k % 3] = x[3 + k] - x[k % 3];
    for (int e = 0; e < 3; ++e) { // det grad L_1 = (p2 - p0) x (p3 - p0) and cyclic
        const R *b = edge[(e + 1) % 3], *c = edge[(e + 2) % 3];
        for (int k = 0; k < 3; ++k)
            tet.g[e][k] = b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3];
    }
    const R det = edge[0][0] * tet.g[0][0] + edge[0][1] * tet.g[0][1] + edge[0][2] * tet.g[0][2];
    const R scale = T(1) / (T(6) * (det < R{} ? -det : det));
    tet.lambda *= scale;
    tet.mu *= scale;
}

/// What a batch holds of its tets.
template <int n, class T, int lanes>
BEZSOMA_INLINE Batch<T, lanes> batch_of_tets(const Batches<T> &b, std::int64_t i) {
    Batch<T, lanes> tet = {};
    for (int l = 0; l < lanes; ++l) {
        tet.lambda[l] = b.lame[2 * b.region[i * lanes + l]];
        tet.mu[l] = b.lame[2 * b.region[i * lanes + l] + 1];
    }
    if constexpr (forms_shapes<T>(n)) {
        form_shapes<T, lanes>(b.geometry, b.first + i * entities(1) * lanes, tet);
    } else {
        for (int k = 0; k < 9; ++k)
            tet.g[k / 3][k % 3] = load<T, lanes>(b.geometry + (9 * i + k) * lanes);
    }
    return tet;
}

/// Numbers of u, and as many of f, that a batch calls for.
template <int n, class T, int lanes>
constexpr std::int64_t called =
    Ahead<n, T, lanes>::line * Ahead<n, T, lanes>::lines * controls(n - 1);

/// One past the own controls that the stretch of batch i meets, where those of the next begin. Its
/// batches call for them, each for its share: the first of a stretch meets most of what all do.
template <class T> BEZSOMA_INLINE std::int64_t next_stretch(const Batches<T> &b, std::int64_t i) {
    const std::int64_t last = i / apart * apart + apart - 1;
    return b.met[last < b.count ? last : b.count - 1];
}

/// Calls for the shapes and the places of a batch to come, or for what lies past the last. They are
/// read once (which the last 0 says): the second cache is for what the chunk works on.
template <int n, class T, int lanes>
BEZSOMA_INLINE void call_batch(const Batches<T> &b, std::int64_t i) {
    constexpr std::int64_t line = 64, of_shapes = 9 * lanes * sizeof(T),
                           of_places = 4 * entities(n) * lanes;
    const char *shapes = reinterpret_cast<const char *>(b.geometry) + i * of_shapes;
    const char *places = reinterpret_cast<const char *>(b.first) + i * of_places;
    if constexpr (!forms_shapes<T>(n))
        for (std::int64_t k = 0; k < of_shapes; k += line)
            __builtin_prefetch(shapes + k, 0, 0);
    for (std::int64_t k = 0; k < of_places; k += line)
        __builtin_prefetch(places + k, 0, 0);
}

/// Clears the own forces, of `row` numbers a control, that the stretch from batch i on is the first
/// to meet.
template <class T>
BEZSOMA_INLINE void clear(const Batches<T> &b, std::int64_t i, std::int64_t row) {
    const std::int64_t begin = i > 0 ? b.met[i - 1] : 0, end = next_stretch(b, i);
    for (std::int64_t k = begin * row; k < end * row; ++k)
        b.f[k] = 0;
}

/// Takes the own controls that the stretch from batch i on is the first to meet into the area.
template <class T> BEZSOMA_INLINE void enter(const Batches<T> &b, std::int64_t i) {
    const std::int64_t begin = i > 0 ? b.met[i - 1] : 0, end = next_stretch(b, i);
    const T *from = b.u + 3 * begin;
    T *to = b.area + row_of_area * begin;
    for (T *const past = b.area + row_of_area * end; to < past; to += row_of_area, from += 3) {
        store<T, 4>(to, Lanes<T, 4>{from[0], from[1], from[2], T{}});
        store<T, 4>(to + forces_in_row, Lanes<T, 4>{});
    }
}

template <int n, class T, int lanes> void apply(const Batches<T> &b) {
    Lanes<T, lanes> x[3 * controls(n)]; // displacements, then forces
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first + i * entities(n) * lanes;
        call_batch<n, T, lanes>(b, i + 2);
        if (i % apart == 0)
            clear(b, i, 3);
        gather<n, T, lanes>(b, first, x);
        const std::int64_t next = 3 * next_stretch(b, i) + i % apart * called<n, T, lanes>;
        elastic_forces<n, T, lanes>(batch_of_tets<n, T, lanes>(b, i), x, x,
                                    {b.u + next, b.f + next});
        scatter<n, T, lanes>(b, first, x);
    }
}

template <int n, class T, int lanes> void apply_in_area(const Batches<T> &given) {
    // A copy no store could change: its pointers stay in registers, which degree 3 has not.
    const Batches<T> b = given;
    Lanes<T, lanes> x[3 * controls(n)]; // displacements, then forces
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first + i * entities(n) * lanes;
        call_batch<n, T, lanes>(b, i + 2);
        if (i % apart == 0)
            enter(b, i);
        gather<n, T, lanes>(b.area, first, x);
        const std::int64_t next = 3 * next_stretch(b, i) + i % apart * called<n, T, lanes>;
        elastic_forces<n, T, lanes>(batch_of_tets<n, T, lanes>(b, i), x, x,
                                    {b.u + next, b.f + next});
        scatter<n, T, lanes, 1>(b.area + forces_in_row, first, x);
    }
}

template <int n, class T, int lanes> double work(const Batches<T> &b) {
    Lanes<T, lanes> u[3 * controls(n)], sum = {};
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first + i * entities(n) * lanes;
        if constexpr (in_area<n, lanes>) {
            if (i % apart == 0)
                enter(b, i);
            gather<n, T, lanes>(b.area, first, u);
        } else {
            gather<n, T, lanes>(b, first, u);
        }
        sum += elastic_work<n, T, lanes>(batch_of_tets<n, T, lanes>(b, i), u,
                                         b.u + 3 * next_stretch(b, i) +
                                             i % apart * called<n, T, lanes>);
    }
    double all = 0;
    for (int l = 0; l < lanes; ++l)
        all += sum[l];
    return all;
}

/// What one lane of a batch holds, in all of `beside` lanes.
template <class T, int lanes, int beside>
BEZSOMA_INLINE Batch<T, beside> tet_of_lane(const Batch<T, lanes> &batch, int lane) {
    Batch<T, beside> tet = {};
    for (int k = 0; k < 9; ++k)
        tet.g[k / 3][k % 3] = Lanes<T, beside>{} + batch.g[k / 3][k % 3][lane];
    tet.lambda = Lanes<T, beside>{} + batch.lambda[lane];
    tet.mu = Lanes<T, beside>{} + batch.mu[lane];
    return tet;
}

/// Lanes are sides here, `beside` at once (the last ones may be fewer), and batches are read tet by
/// tet.
template <int n, class T, int lanes, int beside>
void apply_beside(const Batches<T> &given, int sides) {
    const Batches<T> b = given;          // in registers, as in `apply_in_area`
    Lanes<T, beside> x[3 * controls(n)]; // displacements, then forces
    const int end = sides_beside(lanes, sides);
    std::int64_t next = 0;
    for (std::int64_t i = 0; i < b.count; ++i) {
        if (i % apart == 0) {
            clear(b, i, 3 * sides);
            next = 3 * next_stretch(b, i) * sides;
        }
        const Batch<T, lanes> batch = batch_of_tets<n, T, lanes>(b, i);
        for (int lane = 0; lane < lanes; ++lane) {
            const std::int32_t *first = b.first + i * entities(n) * lanes + lane;
            const Batch<T, beside> tet = tet_of_lane<T, lanes, beside>(batch, lane);
            for (int side = 0; side < end; side += beside) {
                each_run_of_tet<n>([&]<int rows>(auto entity, auto row) BEZSOMA_INLINED {
                    const T *from =
                        place(b.u, b.u_end, run<n, lanes>(first[entity * lanes], sides)) + side;
#pragma GCC unroll 16
                    for (int r = 0; r < rows; ++r)
                        x[entity_order<n>.row[row + r]] = load<T, beside>(from + r * sides);
                });
                elastic_forces<n, T, beside>(tet, x, x, {b.u + next, b.f + next});
                // What a batch brings of one side a tet brings of as many as there are lanes.
                next += called<n, T, beside>;
                const auto forces = [&](const auto &add) BEZSOMA_INLINED {
                    each_run_of_tet<n>([&]<int rows>(auto entity, auto row) BEZSOMA_INLINED {
                        T *to =
                            place(b.f, b.f_end, run<n, lanes>(first[entity * lanes], sides)) + side;
#pragma GCC unroll 16
                        for (int r = 0; r < rows; ++r)
                            add(to + r * sides, x[entity_order<n>.row[row + r]]);
                    });
                };
                using R = Lanes<T, beside>;
                if (end - side >= beside)
                    forces([](T *to, R v)
                               BEZSOMA_INLINED { store<T, beside>(to, load<T, beside>(to) + v); });
                else
                    forces([many = end - side](T *to, R v)
                               BEZSOMA_INLINED { add_first<T, beside>(to, v, many); });
            }
        }
    }
}

template <int n, class T, int lanes> void apply_many(const Batches<T> &b, int sides) {
    constexpr int few = lanes < 4 ? lanes : 4;
    if constexpr (lanes >= 8)
        if (by_eights(lanes, sides))
            return apply_beside<n, T, lanes, 8>(b, sides);
    apply_beside<n, T, lanes, few>(b, sides);
}

constexpr int lanes64 = BEZSOMA_BYTES / 8, lanes32 = BEZSOMA_BYTES / 4;

template <int n, class T, int lanes> static constexpr Kernel<T> kernel_of_degree() {
    if constexpr (n > BEZSOMA_HIGHEST_DEGREE)
        return {};
    else if constexpr (in_area<n, lanes>)
        return {row_of_area, apply_in_area<n, T, lanes>, apply_many<n, T, lanes>,
                work<n, T, lanes>};
    else
        return {3, apply<n, T, lanes>, apply_many<n, T, lanes>, work<n, T, lanes>};
}

#define BEZSOMA_DEGREES(T, lanes)                                                                  \
    {kernel_of_degree<1, T, lanes>(), kernel_of_degree<2, T, lanes>(),                             \
     kernel_of_degree<3, T, lanes>(), kernel_of_degree<4, T, lanes>(),                             \
     kernel_of_degree<5, T, lanes>(), kernel_of_degree<6, T, lanes>(),                             \
     kernel_of_degree<7, T, lanes>(), kernel_of_degree<8, T, lanes>(),                             \
     kernel_of_degree<9, T, lanes>(), kernel_of_degree<10, T, lanes>()}

template <int n, int dim> static constexpr BlockKernel block_kernel() {
    if constexpr (inside(n, dim) > 0 && n <= BEZSOMA_HIGHEST_DEGREE)
        return {forward<n, dim, lanes64>, back<n, dim, lanes64>};
    else
        return {};
}

#define BEZSOMA_BLOCKS(n)                                                                          \
    {block_kernel<n, 0>(), block_kernel<n, 1>(), block_kernel<n, 2>(), block_kernel<n, 3>()}
#define BEZSOMA_TEXT_OF(name) #name
#define BEZSOMA_TEXT(name) BEZSOMA_TEXT_OF(name)

extern const PointwiseKernels pointwise_kernels;
extern const MixedKernels mixed_kernels;
extern const RowKernels row_kernels;
extern const Kernels kernels;
constinit const Kernels kernels = {BEZSOMA_TEXT(BEZSOMA_ISA),
                                   lanes64,
                                   lanes32,
                                   BEZSOMA_DEGREES(double, lanes64),
                                   BEZSOMA_DEGREES(float, lanes32),
                                   {BEZSOMA_BLOCKS(1), BEZSOMA_BLOCKS(2), BEZSOMA_BLOCKS(3),
                                    BEZSOMA_BLOCKS(4), BEZSOMA_BLOCKS(5), BEZSOMA_BLOCKS(6),
                                    BEZSOMA_BLOCKS(7), BEZSOMA_BLOCKS(8), BEZSOMA_BLOCKS(9),
                                    BEZSOMA_BLOCKS(10)},
                                   &pointwise_kernels,
                                   &mixed_kernels,
                                   &row_kernels};

} // namespace bezsoma::BEZSOMA_ISA
