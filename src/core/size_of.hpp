// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace bezsoma {

/// A count or a number of something, as vectors take them.
inline std::size_t size_of(std::int64_t n) { return static_cast<std::size_t>(n); }

} // namespace bezsoma
