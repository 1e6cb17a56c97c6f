#include "arrays.h"

namespace abbe::python {

std::string ShapeText(const py::array& array) {
  return py::str(py::tuple(array.attr("shape"))).cast<std::string>();
}

Eigen::Map<const Eigen::MatrixXd> ColumnsOf(const Array& array, Eigen::Index columns,
                                            const char* name) {
  if (array.ndim() != 2 || array.shape(1) != columns) {
    throw InputError(fmt::format("{}: has the shape {}; give one row of {} numbers each, (n, {})",
                                 name, ShapeText(array), columns, columns));
  }
  return {array.data(), columns, array.shape(0)};
}

Eigen::Map<const Eigen::VectorXd> Numbers(const Array& array, Eigen::Index size, const char* name) {
  if (array.ndim() != 1 || array.shape(0) != size) {
    throw InputError(fmt::format("{}: has the shape {}; give ({},)", name, ShapeText(array), size));
  }
  return {array.data(), array.shape(0)};
}

}  // namespace abbe::python
