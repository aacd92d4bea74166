// SPDX-License-Identifier: BSD-3-Clause
// Foreign controls of a chunk, between the vectors of a mesh and the area of the chunk. Control by
// control: to join neighbours to runs would save little, and their lengths would be branches that
// no processor foresees.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "chunks.hpp"

namespace bezsoma {

/// Calls work(row, step) for controls of so many numbers, so far from each other; three beside each
/// other, which most have, are known when this is compiled.
template <class Work> void with_row(std::int64_t row, std::int64_t step, const Work &work) {
    if (row == 3 && step == 1)
        work(std::integral_constant<std::int64_t, 3>{}, std::integral_constant<std::int64_t, 1>{});
    else
        work(row, step);
}

/// Copies the rows of these controls in x one after another; returns the end of what was written.
/// One side of several is rows of 3 with a step of as many.
template <class T>
T *copy_rows(const std::vector<std::int32_t> &controls, const T *x, std::int64_t row, T *to,
             std::int64_t step = 1) {
    with_row(row, step, [&](auto wide, auto apart) {
        for (const std::int32_t control : controls)
            for (std::int64_t k = 0; k < wide; ++k)
                *to++ = x[(wide * control + k) * apart];
    });
    return to;
}

/// Adds what stands one after another, `from_row` numbers each, to the rows of these controls in x.
template <class T>
void add_rows(const std::vector<std::int32_t> &controls, const T *from, std::int64_t from_row, T *x,
              std::int64_t row, std::int64_t step = 1) {
    with_row(row, step, [&](auto wide, auto apart) {
        const T *next = from; // copies: what is captured is loaded anew after every store
        T *const all = x;
        for (const std::int32_t control : controls) {
            T *to = all + wide * control * apart;
            for (std::int64_t k = 0; k < wide; ++k)
                to[k * apart] += next[k];
            next += from_row;
        }
    });
}

/// The same from wherever each addition stands.
template <class T>
void add_rows(const std::vector<Addition> &added, const T *from, T *x, std::int64_t row) {
    with_row(row, 1, [&](auto wide, auto) {
        for (const Addition &one : added)
            for (std::int64_t k = 0; k < wide; ++k)
                x[wide * one.control + k] += from[wide * one.from + k];
    });
}

} // namespace bezsoma
