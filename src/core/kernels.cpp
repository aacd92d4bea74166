// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "kernels.hpp"

namespace bezsoma {

namespace baseline {
extern const Kernels kernels;
}
#ifdef BEZSOMA_X86
namespace avx2 {
extern const Kernels kernels;
}
namespace avx512 {
extern const Kernels kernels;
}
#endif

const Kernels *kernels_named(const char *name) {
#ifdef BEZSOMA_X86
    __builtin_cpu_init();
    if (!std::strcmp(name, avx512::kernels.name) && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd"))
        return &avx512::kernels;
    if (!std::strcmp(name, avx2::kernels.name) && __builtin_cpu_supports("avx2") &&
        __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
        return &avx2::kernels;
#endif
    return std::strcmp(name, baseline::kernels.name) ? nullptr : &baseline::kernels;
}

const Kernels &best_kernels() {
    if (const Kernels *found = kernels_named("avx512"))
        return *found;
    if (const Kernels *found = kernels_named("avx2"))
        return *found;
    return baseline::kernels;
}

} // namespace bezsoma
