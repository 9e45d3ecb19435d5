#include <tbb/global_control.h>

#include <exception>
#include <optional>
#include <string>

#include "base/message.h"
#include "base/progress.h"
#include "bindings/bindings.h"

namespace stormfield::bindings {

namespace {

/// Raises the class that the module has under this name at the time of the fault.
void raise(const char* name, const std::exception& fault) {
  py::set_error(py::module_::import("stormfield_native").attr(name), fault.what());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const MeshError& fault) {
    raise("MeshError", fault);
  } catch (const InputError& fault) {
    raise("InputError", fault);
  } catch (const SolverError& fault) {
    raise("SolverError", fault);
  } catch (const Cancelled& fault) {
    raise("Cancelled", fault);
  }
}

py::object errorClass(const char* name, const py::handle& base, const char* doc) {
  const std::string full = std::string("stormfield_native.") + name;
  return py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full.c_str(), doc, base.ptr(), nullptr));
}

void setInputError(py::module_& m, const py::object& input) {
  m.attr("InputError") = input;
  m.attr("MeshError") = errorClass("MeshError", input, "The mesh is not an oriented 2-manifold of proper triangles.");
}

/// The largest number of threads of the core, while it is entered.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count) : count_(count) {
    if (count < 1) throw InputError(message("a limit of ", count, " threads; give at least 1"));
  }
  void enter() { control_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count_)); }
  void exit() { control_.reset(); }

 private:
  int count_;
  std::optional<tbb::global_control> control_;
};

}  // namespace

void bind_base(py::module_& m) {
  py::register_local_exception_translator(translate);
  setInputError(m, errorClass("InputError", PyExc_ValueError,
                              "The data cannot be used; the message names the element and the cure."));
  m.attr("SolverError") = errorClass("SolverError", PyExc_RuntimeError, "The solver did not reach its tolerance.");
  m.attr("Cancelled") = errorClass("Cancelled", PyExc_RuntimeError, "The work was stopped through its Progress.");
  m.def(
      "set_input_error",
      [](const py::type& input) {
        py::module_ module = py::module_::import("stormfield_native");
        setInputError(module, input);
      },
      py::arg("input_error"),
      "Raise this class, derived from ValueError, in place of InputError from now on, and as the base of MeshError: a\n"
      "program that has an error of its own for its user's data catches the core's as well.");

  py::class_<Progress, std::shared_ptr<Progress>>(
      m, "Progress", py::module_local(),
      "Progress and cancellation of long work; safe to use from any thread. One for each piece of work.")
      .def(py::init<>())
      .def_property_readonly("fraction", &Progress::fraction, "Fraction of the work that is done, 0 to 1.")
      .def_property_readonly("cancelled", &Progress::cancelled, "Whether cancel() was called.")
      .def("cancel", &Progress::cancel, "Ask the worker to stop; it raises Cancelled within 0.1 s.");

  py::class_<ThreadLimit>(
      m, "ThreadLimit", py::module_local(),
      "with ThreadLimit(count): the core uses that many threads at most, in all of the process. The\n"
      "results are the same for any number. Where limits meet, the smallest counts.")
      .def(py::init<int>(), py::arg("count"), "count: of threads, at least 1. Raises InputError for fewer.")
      .def("__enter__", [](ThreadLimit& limit) { limit.enter(); })
      .def("__exit__", [](ThreadLimit& limit, const py::args&) { limit.exit(); });
}

}  // namespace stormfield::bindings
