// SPDX-License-Identifier: BSD-3-Clause
#include "team.hpp"

#include <algorithm>

namespace bezsoma {

namespace {

// Jobs follow each other within microseconds, while sleeping and waking takes some 50.
constexpr int patience = 4000;

template <class Done> bool soon(const Done &done) {
    for (int i = 0; i < patience; ++i) {
        if (done())
            return true;
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }
    return false;
}

} // namespace

Team::Team(std::size_t threads) {
    const std::size_t all = threads ? threads : std::max(1U, std::thread::hardware_concurrency());
    others_.reserve(all - 1);
    for (std::size_t i = 1; i < all; ++i)
        others_.emplace_back([this, i] { wait_for_jobs(i); });
}

Team::~Team() {
    leave_ = true;
    job_.fetch_add(1, std::memory_order_release);
    job_.notify_all();
    for (auto &thread : others_)
        thread.join();
}

void Team::run(std::size_t pieces, const std::function<void(std::size_t, std::size_t)> &work) {
    if (poll_) {
        const auto now = std::chrono::steady_clock::now();
        if (now - polled_ > std::chrono::milliseconds(100)) {
            polled_ = now;
            poll_();
        }
    }
    if (others_.empty() || pieces <= 1) {
        for (std::size_t i = 0; i < pieces; ++i)
            work(i, 0);
        return;
    }
    work_ = &work;
    pieces_ = pieces;
    next_.store(0, std::memory_order_relaxed);
    busy_.store(others_.size(), std::memory_order_relaxed);
    job_.fetch_add(1, std::memory_order_release);
    job_.notify_all();
    take_pieces(0);
    const auto done = [this] { return busy_.load(std::memory_order_acquire) == 0; };
    while (!soon(done))
        if (const std::size_t left = busy_.load(std::memory_order_acquire); left > 0)
            busy_.wait(left, std::memory_order_acquire);
}

void Team::take_pieces(std::size_t thread) {
    for (;;) {
        const std::size_t piece = next_.fetch_add(1, std::memory_order_relaxed);
        if (piece >= pieces_)
            return;
        (*work_)(piece, thread);
    }
}

void Team::wait_for_jobs(std::size_t thread) {
    std::uint32_t seen = 0;
    for (;;) {
        const auto called = [&] { return job_.load(std::memory_order_acquire) != seen; };
        while (!soon(called))
            job_.wait(seen, std::memory_order_acquire);
        ++seen;
        if (leave_)
            return;
        take_pieces(thread);
        if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1)
            busy_.notify_all();
    }
}

} // namespace bezsoma
