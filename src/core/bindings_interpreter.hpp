// SPDX-License-Identifier: BSD-3-Clause
// How a thread leaves Python's interpreter for a computation, and comes back.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <thread>

#if defined(__GLIBCXX__)
#include <cxxabi.h>
#endif

namespace bezsoma {

/// What may ask for the interpreter: it does not return where Python has ended.
///
/// Python before 3.14 ends whatever thread then asks (a daemon in the midst of a solve) by
/// unwinding its stack, which ends the whole process by abort where a destructor is met. Such a
/// thread stays here instead, as later versions have it stay, and goes with the process.
template <class Ask> void staying(const Ask &ask) {
#if defined(__GLIBCXX__)
    try {
        ask();
    } catch (abi::__forced_unwind &) {
        for (;;)
            std::this_thread::sleep_for(std::chrono::hours(1));
    }
#else // no thread is unwound where this is not the library
    ask();
#endif
}

/// The thread has not got the interpreter for as long as this lives.
class Outside {
public:
    Outside() : state_(PyEval_SaveThread()) {}
    ~Outside() {
        staying([&] { PyEval_RestoreThread(state_); });
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
        staying([&] { state_ = PyGILState_Ensure(); });
    }
    ~Inside() { PyGILState_Release(state_); }
    Inside(const Inside &) = delete;
    Inside &operator=(const Inside &) = delete;

private:
    PyGILState_STATE state_{};
};

/// Tells a function of Python's, which the caller keeps, of an iteration. No frame of C++ may lie
/// between the two, as those of nanobind would: what Python runs asks for the interpreter again.
class Report {
public:
    explicit Report(const nanobind::callable &told) : told_(told.ptr()) {}

    void operator()(int iteration, double residual) const {
        const Inside held;
        PyObject *answer = nullptr;
        staying([&] { answer = PyObject_CallFunction(told_, "id", iteration, residual); });
        if (!answer)
            throw nanobind::python_error();
        Py_DECREF(answer);
    }

private:
    PyObject *told_;
};

} // namespace bezsoma
