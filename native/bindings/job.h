// Work on a C++ thread that Python starts, watches without blocking, and stops.
//
// The thread never touches Python: the work gets plain C++ data and a Progress, and its result (or exception) waits
// until it is asked for. A job that Python lets go of is cancelled and waited for.
//
//   const auto solve = [=](Progress& progress) { return solver->solve(constraints, progress); };
//   const auto job = std::make_shared<Job<SpaceTimeResult>>(solve);
//   bindJob<Job<SpaceTimeResult>>(m, "SolveJob", "A running solve.", toPython);  // once, in the module
//
// The work must not capture Python objects: its captures end on the other thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <pybind11/stl.h>

#include "base/progress.h"
#include "bindings/arrays.h"

namespace stormfield::bindings {

template <typename T>
class Job {
 public:
  explicit Job(std::function<T(Progress&)> work, std::shared_ptr<Progress> progress = nullptr)
      : progress_(progress ? std::move(progress) : std::make_shared<Progress>()) {
    std::packaged_task<T()> task([work = std::move(work), p = progress_] { return work(*p); });
    result_ = task.get_future().share();
    thread_ = std::thread(std::move(task));
  }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job() {
    progress_->cancel();
    thread_.join();
  }

  const std::shared_ptr<Progress>& progress() const { return progress_; }
  /// Waits at most so long (seconds); whether the work has ended.
  bool wait(double timeout) const {
    return result_.wait_for(std::chrono::duration<double>(timeout)) == std::future_status::ready;
  }
  void wait() const { result_.wait(); }
  bool done() const { return wait(0.0); }
  /// Waits; rethrows what the work threw.
  const T& result() const { return result_.get(); }

 private:
  std::shared_ptr<Progress> progress_;
  std::shared_future<T> result_;
  std::thread thread_;
};

/// Python's view of a job; toPython makes the object that result() returns.
template <typename J, typename ToPython>
void bindJob(py::module_& m, const char* name, const char* doc, const ToPython& toPython) {
  py::class_<J, std::shared_ptr<J>>(m, name, py::module_local(), doc)
      .def_property_readonly(
          "fraction", [](const J& job) { return job.progress()->fraction(); }, "Part of the work that is done, 0 to 1.")
      .def_property_readonly("done", &J::done, "Whether the work has ended, by itself or not. Never blocks.")
      .def_property_readonly(
          "cancelled", [](const J& job) { return job.progress()->cancelled(); }, "Whether cancel() was called.")
      .def(
          "cancel", [](const J& job) { job.progress()->cancel(); }, "Ask the work to stop; it does within 0.1 s.")
      .def(
          "wait",
          [](const J& job, const std::optional<double>& timeout) {
            if (timeout && !(*timeout >= 0.0)) throw InputError("the timeout must be at least 0 s");
            const py::gil_scoped_release release;
            if (timeout && std::isfinite(*timeout)) return job.wait(std::min(*timeout, 1e8));
            job.wait();
            return true;
          },
          py::arg("timeout") = py::none(), "Wait at most timeout seconds (None: without limit); whether it has ended.")
      .def(
          "result",
          [toPython](const J& job) {
            {
              const py::gil_scoped_release release;
              job.wait();
            }
            return toPython(job.result());
          },
          "Wait for the result; raises what the work raised (Cancelled after cancel()).");
}

}  // namespace stormfield::bindings
