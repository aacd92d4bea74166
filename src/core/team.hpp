// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "size_of.hpp"

namespace bezsoma {

/// Threads that wait between jobs: a solve hands out thousands of jobs of some 100 us.
///
/// A job is a number of pieces; whichever thread is free takes the next. Answers do not depend on
/// the number of threads as long as each piece writes where no other does.
class Team {
public:
    /// All cores for 0, and no more than `most`. The calling thread is one of them.
    explicit Team(std::size_t threads, std::size_t most = std::numeric_limits<std::size_t>::max());
    ~Team();
    Team(const Team &) = delete;
    Team &operator=(const Team &) = delete;

    std::size_t size() const { return size_; }

    /// Asked now and then, by the thread that runs the jobs; it may throw, which is how a user
    /// stops a long computation.
    void watch(std::function<void()> poll) { poll_ = std::move(poll); }

    /// Asks the watch if that has not been done for a while: in long work outside of jobs.
    void ask();

    /// Runs work(piece, thread) for every piece; returns when all are done.
    ///
    /// What a piece throws, here or in another thread, is thrown here once all threads are idle;
    /// pieces not yet begun are then left out, and the team is as before. A job cannot begin
    /// another one on the same team.
    void run(std::size_t pieces, const std::function<void(std::size_t, std::size_t)> &work);

private:
    void begin_threads();
    void abandon_threads_of_the_parent();
    void share_out();
    void wait_for_jobs(std::size_t thread);
    void take_pieces(std::size_t thread);

    std::size_t size_;
    std::vector<std::thread> others_;
    const std::function<void(std::size_t, std::size_t)> *work_ = nullptr;
    std::size_t pieces_ = 0;
    std::atomic<std::size_t> next_{0};
    std::atomic<std::size_t> busy_{0};
    std::atomic<std::uint32_t> job_{0};
    std::function<void()> poll_;
    std::chrono::steady_clock::time_point polled_{};
    std::mutex failing_;
    std::exception_ptr failure_;
    bool running_ = false;
    bool leave_ = false;
    long process_; // the one in which the threads are
};

/// Runs work(i) for i = 0, 1, ..., count - 1 one after the other: long work that no job can share.
template <class Work> void in_turn(Team &team, std::size_t count, const Work &work) {
    constexpr std::size_t stretch = 1 << 16;
    for (std::size_t begin = 0; begin < count; begin += stretch) {
        team.ask();
        for (std::size_t i = begin; i < std::min(begin + stretch, count); ++i)
            work(i);
    }
}

} // namespace bezsoma
