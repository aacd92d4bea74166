// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace bezsoma {

/// All cores for 0, else the number asked for; never more than there are chunks of `least` items.
inline std::size_t workers(std::size_t asked, std::size_t items, std::size_t least) {
    const std::size_t cores = asked ? asked : std::max(1U, std::thread::hardware_concurrency());
    return std::clamp<std::size_t>(items / least, 1, cores);
}

/// Runs work(worker, first, last) over a contiguous share of the items on each worker.
///
/// Every item is owned by one worker, so the answer does not depend on how many there are. The
/// work must not throw.
template <typename Work>
void share(std::size_t items, std::size_t number_of_workers, const Work &work) {
    std::vector<std::thread> others;
    others.reserve(number_of_workers);
    const auto first = [=](std::size_t w) { return items * w / number_of_workers; };
    for (std::size_t w = 1; w < number_of_workers; ++w)
        others.emplace_back([&, w] { work(w, first(w), first(w + 1)); });
    work(0, 0, first(1));
    for (auto &thread : others)
        thread.join();
}

} // namespace bezsoma
