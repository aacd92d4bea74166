// SPDX-License-Identifier: BSD-3-Clause
#include "team.hpp"

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#include <unistd.h>
#endif

namespace bezsoma {

namespace {

// Jobs follow each other within microseconds, while sleeping and waking takes some 50.
constexpr int patience = 4000;
constexpr std::chrono::milliseconds between_polls{100};

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

long this_process() {
#if defined(__unix__) || defined(__APPLE__)
    return static_cast<long>(getpid());
#else
    return 0;
#endif
}

} // namespace

Team::Team(std::size_t threads, std::size_t most)
    : size_(threads ? threads : std::max(1U, std::thread::hardware_concurrency())),
      process_(this_process()) {
    size_ = std::clamp<std::size_t>(most, 1, size_);
    begin_threads();
}

Team::~Team() {
    if (process_ != this_process()) {
        abandon_threads_of_the_parent();
        return;
    }
    leave_ = true;
    job_.fetch_add(1, std::memory_order_release);
    job_.notify_all();
    for (auto &thread : others_)
        thread.join();
}

/// Fewer where the system has no more to give: answers are the same, and `size` tells.
void Team::begin_threads() {
    others_.reserve(size_ - 1);
    try {
        for (std::size_t i = 1; i < size_; ++i)
            others_.emplace_back([this, i] { wait_for_jobs(i); });
    } catch (const std::system_error &) {
        size_ = others_.size() + 1;
    }
}

/// After a fork the child has this object and none of its threads: they can neither be joined nor
/// let go, so their handles are left where they are.
void Team::abandon_threads_of_the_parent() {
    [[maybe_unused]] const auto *leaked = new std::vector<std::thread>(std::move(others_));
    others_.clear();
}

void Team::ask() {
    if (!poll_)
        return;
    const auto now = std::chrono::steady_clock::now();
    if (now - polled_ < between_polls)
        return;
    polled_ = now;
    poll_();
}

void Team::run(std::size_t pieces, const std::function<void(std::size_t, std::size_t)> &work) {
    if (running_)
        throw std::logic_error("a job on an operator's threads is under way: what interrupts it "
                               "cannot use the same operator");
    if (process_ != this_process()) {
        abandon_threads_of_the_parent();
        process_ = this_process();
        job_ = 0;
        begin_threads();
    }
    running_ = true;
    work_ = &work;
    pieces_ = pieces;
    next_.store(0, std::memory_order_relaxed);
    if (others_.empty() || pieces <= 1)
        take_pieces(0);
    else
        share_out();
    running_ = false;
    if (failure_)
        std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Team::share_out() {
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
    try {
        for (;;) {
            if (thread == 0)
                ask();
            const std::size_t piece = next_.fetch_add(1, std::memory_order_relaxed);
            if (piece >= pieces_)
                return;
            (*work_)(piece, thread);
        }
    } catch (...) {
        next_.store(pieces_, std::memory_order_relaxed); // nothing is left to begin
        const std::lock_guard one_by_one(failing_);
        if (!failure_)
            failure_ = std::current_exception();
    }
}

void Team::wait_for_jobs(std::size_t thread) {
    // What a thread keeps of exceptions is taken from memory when first asked for; were there none
    // left when a job throws for want of it, that would end the process.
    [[maybe_unused]] const int none = std::uncaught_exceptions();
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
