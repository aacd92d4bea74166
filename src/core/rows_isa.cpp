// SPDX-License-Identifier: BSD-3-Clause
// The multigrid's rows, compiled once for each instruction set as kernels_isa.cpp is, and like it
// without anything of the standard library.
#include "row_kernels.hpp"

#include "lanes.hpp"

namespace bezsoma::BEZSOMA_ISA {

using Eight = Lanes<float, 8>; // hold the motions of a row

/// Holds a column of a block.
template <int n> using Register = Lanes<float, n == 3 ? 4 : 8>;

// The compiler splits registers that the processor does not have. By reference, so that no calling
// convention depends on the instruction set.
template <class R> BEZSOMA_INLINE void read(const float *from, R &to) {
    __builtin_memcpy(&to, from, sizeof to);
}

template <class R> BEZSOMA_INLINE void write(float *to, const R &from) {
    __builtin_memcpy(to, &from, sizeof from);
}

/// n numbers where more may not be written.
template <int n, class R> BEZSOMA_INLINE void write_exactly(float *to, const R &from) {
    __builtin_memcpy(to, &from, n * sizeof(float));
}

/// A sum of products of blocks (n, n), that stand column by column, with vectors: in three parts,
/// as an addition takes several times as long to finish as to start.
template <int n> struct Sum {
    Register<n> part[3] = {};

    BEZSOMA_INLINE void add(const float *block, const float *x) {
        Register<n> column;
#pragma GCC unroll 6
        for (int l = 0; l < n; ++l) {
            read(block + n * l, column);
            part[l % 3] += column * x[l];
        }
    }

    /// Adds the row of A x at hand, from block to block.
    BEZSOMA_INLINE void add(const RowsSeen &a, std::int64_t begin, std::int64_t end,
                            const float *x) {
        for (std::int64_t at = begin; at < end; ++at)
            add(a.value + at * n * n, x + std::int64_t{a.column[at]} * n);
    }

    BEZSOMA_INLINE void total(Register<n> &to) const { to = part[0] + part[1] + part[2]; }
};

/// y = a block times what a sum comes to.
template <int n> BEZSOMA_INLINE void times(const float *block, const Register<n> &x, float *y) {
    float numbers[8];
    write(numbers, x);
    Sum<n> sum;
    sum.add(block, numbers);
    Register<n> total;
    sum.total(total);
    write_exactly<n>(y, total);
}

/// z = D^-1 (r - sum) in one row.
template <int n>
BEZSOMA_INLINE void solve_row(const float *inverse, const Sum<n> &sum, const float *r, float *z) {
    Register<n> rest = {}, total;
    __builtin_memcpy(&rest, r, n * sizeof(float)); // no more may be read
    sum.total(total);
    rest -= total;
    times<n>(inverse, rest, z);
}

template <int n>
void forward(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin, std::size_t end,
             const float *r, float *z) {
    for (std::size_t i = begin; i < end; ++i) {
        Sum<n> sum;
        sum.add(a, a.start[i], diagonal[i], z);
        solve_row<n>(a.value + diagonal[i] * n * n, sum, r + i * n, z + i * n);
    }
}

template <int n>
void later(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin, std::size_t end,
           const float *z, float *residual) {
    for (std::size_t i = begin; i < end; ++i) {
        Sum<n> sum;
        Register<n> total;
        sum.add(a, diagonal[i] + 1, a.start[i + 1], z);
        sum.total(total);
        total = -total;
        write_exactly<n>(residual + i * n, total);
    }
}

/// Calls for a row: what is read backwards the processor does not foresee.
template <int n> BEZSOMA_INLINE void call_row(const RowsSeen &a, std::size_t i) {
    constexpr std::int64_t line = 64 / sizeof(float);
    for (std::int64_t k = a.start[i] * n * n; k < a.start[i + 1] * n * n; k += line)
        __builtin_prefetch(a.value + k);
    __builtin_prefetch(a.column + a.start[i]);
}

template <int n>
void backward(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin, std::size_t end,
              const float *r, float *z) {
    constexpr std::size_t ahead = 6;
    for (std::size_t i = end; i-- > begin;) {
        if (i >= ahead)
            call_row<n>(a, i - ahead);
        Sum<n> sum;
        sum.add(a, a.start[i], diagonal[i], z);
        sum.add(a, diagonal[i] + 1, a.start[i + 1], z);
        solve_row<n>(a.value + diagonal[i] * n * n, sum, r + i * n, z + i * n);
    }
}

template <int n>
void scaled(const RowsSeen &a, const float *inverse, std::size_t begin, std::size_t end,
            const float *x, float *y) {
    for (std::size_t i = begin; i < end; ++i) {
        Sum<n> sum;
        Register<n> total;
        sum.add(a, a.start[i], a.start[i + 1], x);
        sum.total(total);
        times<n>(inverse + i * n * n, total, y + i * n);
    }
}

template <int n>
void prolong(const RowsSeen &p, std::size_t begin, std::size_t end, const float *e, float *z) {
    for (std::size_t i = begin; i < end; ++i) {
        Eight sum[n] = {}, row, from;
        for (std::int64_t at = p.start[i]; at < p.start[i + 1]; ++at) {
            read(e + std::int64_t{p.column[at]} * motions, from);
#pragma GCC unroll 6
            for (int k = 0; k < n; ++k) {
                read(p.value + (at * n + k) * motions, row);
                sum[k] += row * from;
            }
        }
        for (int k = 0; k < n; ++k) // registers hold two numbers more than there are motions
            z[i * n + static_cast<std::size_t>(k)] +=
                ((sum[k][0] + sum[k][1]) + (sum[k][2] + sum[k][3])) + (sum[k][4] + sum[k][5]);
    }
}

template <int n>
void restricted(const RowsSeen &p, const ColumnsSeen &columns, std::size_t begin, std::size_t end,
                const float *r, float *e) {
    constexpr std::int64_t ahead = 12;
    const std::int64_t all = columns.start[end];
    for (std::size_t g = begin; g < end; ++g) {
        Eight sum[3] = {}, row;
        for (std::int64_t c = columns.start[g]; c < columns.start[g + 1]; ++c) {
            if (c + ahead < all) { // the blocks of a column stand far from each other
                const float *next = p.value + std::int64_t{columns.at[c + ahead]} * n * motions;
                __builtin_prefetch(next);
                __builtin_prefetch(next + n * motions - 1);
            }
            const float *block = p.value + std::int64_t{columns.at[c]} * n * motions;
            const float *from = r + std::int64_t{columns.row[c]} * n;
#pragma GCC unroll 6
            for (int k = 0; k < n; ++k) {
                read(block + k * motions, row);
                sum[k % 3] += row * from[k];
            }
        }
        write_exactly<motions>(e + g * motions, sum[0] + sum[1] + sum[2]);
    }
}

template <int n>
void product(const RowsSeen &a, const RowsSeen &p, std::size_t i, const std::int32_t *place,
             float *row) {
    Eight y[n], sum;
    for (std::int64_t at = a.start[i]; at < a.start[i + 1]; ++at) {
        const float *block = a.value + at * n * n;
        const std::int32_t j = a.column[at];
        for (std::int64_t from = p.start[j]; from < p.start[j + 1]; ++from) {
            float *to = row + std::int64_t{place[p.column[from]]} * n * 8;
#pragma GCC unroll 6
            for (int l = 0; l < n; ++l)
                read(p.value + (from * n + l) * motions, y[l]);
#pragma GCC unroll 6
            for (int k = 0; k < n; ++k) {
                read(to + 8 * k, sum);
#pragma GCC unroll 6
                for (int l = 0; l < n; ++l)
                    sum += block[l * n + k] * y[l];
                write(to + 8 * k, sum);
            }
        }
    }
}

template <int n>
void add_products(const float *p, const float *row, const std::int32_t *column, std::size_t blocks,
                  std::int32_t least, const std::int32_t *place, float *sums) {
    Eight x[n], sum;
    for (int k = 0; k < n; ++k)
        read(p + k * motions, x[k]);
    for (std::size_t b = 0; b < blocks; ++b, row += 8 * n) {
        if (column[b] < least)
            continue;
        float *to = sums + std::int64_t{place[column[b]]} * motions * 8;
#pragma GCC unroll 6
        for (int m = 0; m < motions; ++m) {
            read(to + 8 * m, sum);
#pragma GCC unroll 6
            for (int k = 0; k < n; ++k)
                sum += x[k] * row[8 * k + m];
            write(to + 8 * m, sum);
        }
    }
}

template <int n> static constexpr RowKernel row_kernel() {
    return {forward<n>, later<n>,      backward<n>, scaled<n>,
            prolong<n>, restricted<n>, product<n>,  add_products<n>};
}

extern const RowKernels row_kernels;
constinit const RowKernels row_kernels = {row_kernel<3>(), row_kernel<6>()};

} // namespace bezsoma::BEZSOMA_ISA
