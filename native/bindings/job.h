// Work that Python waits for, or starts on a C++ thread, watches without blocking, and stops.
//
// The thread never touches Python: the work gets plain C++ data and a Progress, and its result (or exception) waits
// until it is asked for. A job that Python lets go of is cancelled and waited for.
//
//   // prepare checks its arguments and returns the work.
//   bindJob<SpaceTimeResult>(m, "SolveJob", "A running solve.", [](const SpaceTimeResult& r) { return toPython(r); })
//       .def(m, "solve", &prepare, "The field.", py::arg("constraints"));  // solve, and start_solve without waiting
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
#include <string>
#include <thread>
#include <utility>

#include <pybind11/stl.h>

#include "base/progress.h"
#include "bindings/arrays.h"

namespace stormfield::bindings {

template <typename T>
using Work = std::function<T(Progress&)>;

template <typename T>
class Job {
 public:
  explicit Job(Work<T> work, std::shared_ptr<Progress> progress = nullptr)
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

/// A bound class of jobs, and the functions that start them.
template <typename T, typename ToPython>
class JobBinding {
 public:
  JobBinding(const char* name, ToPython toPython) : name_(name), toPython_(std::move(toPython)) {}

  /// `name`, which waits for the result, and start_`name`, which returns the job, in a module or class. prepare makes
  /// the work from the arguments, and throws their faults; both functions take a Progress besides.
  template <typename Owner, typename... Args, typename... Extra>
  const JobBinding& def(Owner& owner, const std::string& name, Work<T> (*prepare)(Args...), const std::string& doc,
                        const Extra&... extra) const {
    owner.def(
        name.c_str(),
        [prepare, toPython = toPython_](Args... args, const std::shared_ptr<Progress>& progress) {
          return toPython(done(prepare(std::forward<Args>(args)...), progress));
        },
        extra..., py::arg("progress") = std::shared_ptr<Progress>(), doc.c_str());
    return defStart(owner, name, prepare, doc, extra...);
  }

  /// The same where `name` is the constructor of the results' class; start_`name` is in the module.
  template <typename Class, typename... Args, typename... Extra>
  const JobBinding& defInit(Class& results, py::module_& m, const std::string& name, Work<T> (*prepare)(Args...),
                            const std::string& doc, const Extra&... extra) const {
    results.def(py::init([prepare](Args... args, const std::shared_ptr<Progress>& progress) {
                  return done(prepare(std::forward<Args>(args)...), progress);
                }),
                extra..., py::arg("progress") = std::shared_ptr<Progress>(), doc.c_str());
    return defStart(m, name, prepare, doc, extra...);
  }

  /// start_`name` alone, where `name` is bound in its own way.
  template <typename Owner, typename... Args, typename... Extra>
  const JobBinding& defStart(Owner& owner, const std::string& name, Work<T> (*prepare)(Args...), const std::string& doc,
                             const Extra&... extra) const {
    owner.def(
        ("start_" + name).c_str(),
        [prepare](Args... args, const std::shared_ptr<Progress>& progress) {
          return std::make_shared<Job<T>>(prepare(std::forward<Args>(args)...), progress);
        },
        extra..., py::arg("progress") = std::shared_ptr<Progress>(),
        (doc + "\n\nDoes not wait: returns a " + name_ + ", whose result() waits, and raises what the work raised.")
            .c_str());
    return *this;
  }

  /// The result of the work, done on this thread.
  static T done(const Work<T>& work, const std::shared_ptr<Progress>& progress) {
    const py::gil_scoped_release release;
    Progress own;
    return work(progress ? *progress : own);
  }

 private:
  std::string name_;
  ToPython toPython_;
};

/// Python's view of jobs with results of type T; toPython makes the object that result() returns.
template <typename T, typename ToPython>
JobBinding<T, ToPython> bindJob(py::module_& m, const char* name, const char* doc, const ToPython& toPython) {
  using J = Job<T>;
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
  return {name, toPython};
}

}  // namespace stormfield::bindings
