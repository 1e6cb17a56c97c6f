// NumPy arrays as matrices of Eigen and back, without copies: an array of n rows of k numbers, one row after the
// other, is a matrix of k rows and n columns.
// Failure: InputError with the name of the argument and the shape that is wanted.
// Validity: an argument that is no array of float64 with its rows in order is copied once by NumPy.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "failure/failure.h"

namespace abbe::python {

namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// "(3, 5)", as NumPy prints it.
std::string ShapeText(const py::array& array);

// The rows of an (n, kColumns) array as columns. `name` is that of the argument.
template <int kColumns>
Eigen::Map<const Eigen::Matrix<double, kColumns, Eigen::Dynamic>> Columns(const Array& array,
                                                                          const char* name) {
  if (array.ndim() != 2 || array.shape(1) != kColumns) {
    throw InputError(fmt::format("{}: has the shape {}; give one row of {} numbers each, (n, {})",
                                 name, ShapeText(array), kColumns, kColumns));
  }
  return {array.data(), kColumns, array.shape(0)};
}

// The same for a number of columns that is known at run time.
Eigen::Map<const Eigen::MatrixXd> ColumnsOf(const Array& array, Eigen::Index columns,
                                            const char* name);
// An array of `size` numbers, (size,).
Eigen::Map<const Eigen::VectorXd> Numbers(const Array& array, Eigen::Index size, const char* name);

// A matrix or vector taken over: its columns become the rows of the array.
template <typename Matrix>
py::array Rows(Matrix&& matrix) {
  using Owned = std::remove_cvref_t<Matrix>;
  auto owned = std::make_unique<Owned>(std::forward<Matrix>(matrix));
  const double* data = owned->data();
  std::vector<py::ssize_t> shape{owned->cols(), owned->rows()};
  if (Owned::ColsAtCompileTime == 1) shape = {owned->rows()};
  const py::capsule owner(owned.release(), [](void* p) { delete static_cast<Owned*>(p); });
  return py::array_t<double>(shape, data, owner);
}

// The numbers of `owner`, which are not copied.
inline py::array View(const double* data, std::size_t size, py::handle owner) {
  return py::array_t<double>({static_cast<py::ssize_t>(size)}, {}, data, owner);
}

}  // namespace abbe::python
