// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace bezsoma {

/// Threads that wait between jobs: a solve hands out thousands of jobs of some 100 us.
///
/// A job is a number of pieces; whichever thread is free takes the next. Answers do not depend on
/// the number of threads as long as each piece writes where no other does.
class Team {
public:
    /// All cores for 0. The calling thread is one of them.
    explicit Team(std::size_t threads);
    ~Team();
    Team(const Team &) = delete;
    Team &operator=(const Team &) = delete;

    std::size_t size() const { return others_.size() + 1; }

    /// Asked now and then, by the thread that runs the jobs and between them; it may throw, which
    /// is how a user stops a long computation.
    void watch(std::function<void()> poll) { poll_ = std::move(poll); }

    /// Runs work(piece, thread) for every piece; returns when all are done. Must not throw.
    void run(std::size_t pieces, const std::function<void(std::size_t, std::size_t)> &work);

private:
    void wait_for_jobs(std::size_t thread);
    void take_pieces(std::size_t thread);

    std::vector<std::thread> others_;
    const std::function<void(std::size_t, std::size_t)> *work_ = nullptr;
    std::size_t pieces_ = 0;
    std::atomic<std::size_t> next_{0};
    std::atomic<std::size_t> busy_{0};
    std::atomic<std::uint32_t> job_{0};
    std::function<void()> poll_;
    std::chrono::steady_clock::time_point polled_{};
    bool leave_ = false;
};

} // namespace bezsoma
