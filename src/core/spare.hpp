// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib> // says whether this is glibc

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace bezsoma {

/// Gives memory that nothing uses back to the system, between the stages of a set-up: glibc keeps
/// what arrays of up to 32 MB leave, and the stages to come would stand on top of it.
inline void give_back_spare_memory() {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

} // namespace bezsoma
