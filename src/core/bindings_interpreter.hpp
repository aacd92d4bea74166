// SPDX-License-Identifier: BSD-3-Clause
// How a thread leaves Python's interpreter for a computation, and comes back.
//
// Python before 3.14 ends whatever thread asks for the interpreter once it has ended (a daemon in
// the midst of a solve) by unwinding its stack. Where that meets what may not throw, as most of
// nanobind and all that asks here, it is std::terminate, and would end the whole process by abort.
// Such a thread stays where it is instead, as later versions have it stay, and goes with the
// process.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <thread>

namespace bezsoma {

/// Has threads stay when Python ends.
class End {
public:
    /// Once, when the module is loaded.
    static void prepare() {
        before_ = std::set_terminate(terminate);
        nanobind::module_::import_("atexit").attr("register")(nanobind::cpp_function([] {
            ender_ = std::this_thread::get_id();
            near_ = true;
        }));
    }

private:
    [[noreturn]] static void terminate() {
        while (near_ && std::this_thread::get_id() != ender_)
            std::this_thread::sleep_for(std::chrono::hours(1));
        if (before_)
            before_();
        std::abort();
    }

    static inline std::terminate_handler before_ = nullptr;
    static inline std::thread::id ender_;
    static inline std::atomic<bool> near_{false};
};

/// The thread has not got the interpreter for as long as this lives.
class Outside {
public:
    Outside() : state_(PyEval_SaveThread()) {}
    ~Outside() { PyEval_RestoreThread(state_); }
    Outside(const Outside &) = delete;
    Outside &operator=(const Outside &) = delete;

private:
    PyThreadState *state_;
};

/// The thread has the interpreter for as long as this lives, in the midst of a computation.
class Inside {
public:
    Inside() noexcept : state_(PyGILState_Ensure()) {}
    ~Inside() { PyGILState_Release(state_); }
    Inside(const Inside &) = delete;
    Inside &operator=(const Inside &) = delete;

private:
    PyGILState_STATE state_;
};

/// Tells a function of Python's, which the caller keeps, of an iteration.
class Report {
public:
    explicit Report(const nanobind::callable &told) : told_(told.ptr()) {}

    void operator()(int iteration, double residual) const {
        const Inside held;
        PyObject *answer = call(iteration, residual);
        if (!answer)
            throw nanobind::python_error();
        Py_DECREF(answer);
    }

private:
    /// What Python runs there asks for the interpreter again and again.
    PyObject *call(int iteration, double residual) const noexcept {
        return PyObject_CallFunction(told_, "id", iteration, residual);
    }

    PyObject *told_;
};

} // namespace bezsoma
