// NumPy arrays at the boundary: shapes and types are checked here, so that the core only sees data that fits.
//
// Input arrays must have the exact element type (a silent conversion would hide a caller's mistake and cost a copy);
// any strides are accepted. Throws InputError naming the argument, what came and what is wanted. Parameters are
// ArrayArgument<T>, which takes any object, so that this message and not pybind11's reaches the caller, and which
// signatures and stubs show as an array of T.
#pragma once

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/message.h"
#include "base/types.h"

namespace stormfield::bindings {

namespace py = pybind11;

/// A dimension of any length; kLeading, as the first one, stands for any number of dimensions.
inline constexpr py::ssize_t kAny = -1, kLeading = -2;
using Shape = std::vector<py::ssize_t>;

inline int isAnything(PyObject* object) {
  return object != nullptr;
}

/// A parameter that inputArray checks.
template <typename T>
class ArrayArgument : public py::object {
  PYBIND11_OBJECT_DEFAULT(ArrayArgument, py::object, isAnything)
};

/// A parameter that is one number, or an array that inputArray checks.
template <typename T>
class NumberOrArray : public py::object {
  PYBIND11_OBJECT_DEFAULT(NumberOrArray, py::object, isAnything)
};

std::string describe(const Shape& shape);
/// Throws InputError unless the shapes fit.
void checkShape(const py::array& array, const char* name, const Shape& wanted);

/// The argument as a contiguous array.
template <typename T>
py::array_t<T, py::array::c_style> inputArray(const ArrayArgument<T>& argument, const char* name, const Shape& shape) {
  const std::string type = py::str(py::dtype::of<T>());
  if (!py::isinstance<py::array>(argument)) {
    throw InputError(message(name, " is a ", std::string(py::str(py::type::of(argument).attr("__name__"))),
                             "; give a numpy array of ", type, " with shape ", describe(shape)));
  }
  const auto array = py::reinterpret_borrow<py::array>(argument);
  if (!py::isinstance<py::array_t<T>>(argument)) {
    throw InputError(message(name, " has elements of type ", std::string(py::str(array.dtype())),
                             "; convert it with astype('", type, "')"));
  }
  checkShape(array, name, shape);
  return py::array_t<T, py::array::c_style>(array);
}

/// A view of memory that owner keeps alive; Python cannot write to it.
template <typename T>
py::array_t<T> readOnlyView(const T* data, const std::vector<py::ssize_t>& shape, const py::object& owner) {
  py::array_t<T> view(shape, data, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

template <typename T>
py::array_t<T> copied(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

template <typename T>
std::vector<T> toVector(const py::array_t<T, py::array::c_style>& array) {
  return std::vector<T>(array.data(), array.data() + array.size());
}

inline Points toPoints(const py::array_t<double, py::array::c_style>& array) {
  return Eigen::Map<const Points>(array.data(), array.shape(0), 3);
}

inline py::array_t<double> fromPoints(const Points& points) {
  py::array_t<double> result({static_cast<py::ssize_t>(points.rows()), py::ssize_t{3}});
  std::copy(points.data(), points.data() + points.size(), result.mutable_data());
  return result;
}

}  // namespace stormfield::bindings

namespace pybind11::detail {

template <typename T>
struct handle_type_name<stormfield::bindings::ArrayArgument<T>> {
  static constexpr auto name = const_name("numpy.typing.NDArray[") + npy_format_descriptor<T>::name + const_name("]");
};
template <typename T>
struct handle_type_name<stormfield::bindings::NumberOrArray<T>> {
  static constexpr auto name = const_name("float | ") + handle_type_name<stormfield::bindings::ArrayArgument<T>>::name;
};

}  // namespace pybind11::detail
