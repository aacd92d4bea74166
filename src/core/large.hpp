// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "team.hpp"

namespace bezsoma {

/// Makes n zeros of a vector, in pages of 2 MB where the system gives them: what is kept of a mesh
/// is walked through at every product, and finding small pages takes a part of that time. Only
/// whole pages within it are asked for, so that it takes no more than its size. The team's watch is
/// asked now and then: to clear gigabytes takes seconds.
template <class T> void make_large(std::vector<T> &v, std::size_t n, Team &team) {
    v.clear();
    v.reserve(n);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    constexpr std::uintptr_t page = std::uintptr_t{1} << 21;
    const auto begin = reinterpret_cast<std::uintptr_t>(v.data());
    const std::uintptr_t first = (begin + page - 1) / page * page;
    const std::uintptr_t end = (begin + n * sizeof(T)) / page * page;
    if (first < end)
        madvise(reinterpret_cast<void *>(first), end - first, MADV_HUGEPAGE);
#endif
    constexpr std::size_t piece = (std::size_t{1} << 25) / sizeof(T);
    while (v.size() < n) {
        team.ask();
        v.resize(std::min(n, v.size() + piece));
    }
}

/// The same for a new one.
template <class T> std::vector<T> large(std::size_t n, Team &team) {
    std::vector<T> v;
    make_large(v, n, team);
    return v;
}

/// Bytes of a line of the cache. A register that begins where one does lies in one line.
constexpr std::size_t cache_line = 64;

/// The first number from this one on that begins a line: fewer numbers on than a line has.
template <class T> T *on_line(T *from) {
    const auto past = reinterpret_cast<std::uintptr_t>(from) % cache_line;
    return from + (cache_line - past) % cache_line / sizeof(T);
}

} // namespace bezsoma
