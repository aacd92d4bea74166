// SPDX-License-Identifier: BSD-3-Clause
// How a thread leaves Python's interpreter for a computation, and comes back.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace bezsoma {

/// Through which threads come back to the interpreter, until Python ends.
///
/// Python ends whatever thread then still asks for the interpreter (a daemon in the midst of a
/// solve) by unwinding its stack, which ends the whole process by abort where a destructor is met.
/// Such threads stay where they are instead, as Python itself does with them from 3.14 on.
class Gate {
public:
    /// Before a thread asks for the interpreter; it does not return in one that is too late.
    void ask() {
        ++asking_;
        if (!closed_ || std::this_thread::get_id() == closer_)
            return;
        --asking_;
        for (;;)
            std::this_thread::sleep_for(std::chrono::hours(1));
    }

    /// Once Python's own code goes on, or the interpreter is given back.
    void passed() { --asking_; }

    /// By the thread that ends Python, which has the interpreter. Those who asked before are let
    /// through first, for a second at most: who is told of an iteration may take long.
    void close() {
        closer_ = std::this_thread::get_id();
        closed_ = true;
        const nanobind::gil_scoped_release for_others;
        for (int i = 0; i < 1000 && asking_ > 0; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }

private:
    std::atomic<int> asking_{0};
    std::atomic<bool> closed_{false};
    std::thread::id closer_;
};

inline Gate gate;

/// The thread has not got the interpreter for as long as this lives.
class Outside {
public:
    Outside() : state_(PyEval_SaveThread()) {}
    ~Outside() {
        gate.ask();
        PyEval_RestoreThread(state_);
        gate.passed();
    }
    Outside(const Outside &) = delete;
    Outside &operator=(const Outside &) = delete;

private:
    PyThreadState *state_;
};

/// The thread has the interpreter for as long as this lives, in the midst of a computation.
class Inside {
public:
    Inside() {
        gate.ask();
        state_ = PyGILState_Ensure();
    }
    ~Inside() {
        PyGILState_Release(state_);
        gate.passed();
    }
    Inside(const Inside &) = delete;
    Inside &operator=(const Inside &) = delete;

private:
    PyGILState_STATE state_;
};

} // namespace bezsoma
