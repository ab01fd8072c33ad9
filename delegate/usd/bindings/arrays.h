// Arrays for Python.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <vector>

namespace msbvh::python {

// A copy of the values as Scalars of that shape.
template <typename Scalar, typename Element>
nanobind::object owned_array(const std::vector<Element>& values, std::initializer_list<std::size_t> shape) {
  Element* data = new Element[std::max<std::size_t>(values.size(), 1)];
  const nanobind::capsule owner(data, [](void* p) noexcept { delete[] static_cast<Element*>(p); });
  std::ranges::copy(values, data);
  return nanobind::cast(nanobind::ndarray<nanobind::numpy, Scalar>(data, shape, owner));
}

// The values as Scalars of that shape: read-only, without a copy, for properties that keep their object
// alive.
template <typename Scalar, typename Element>
nanobind::ndarray<nanobind::numpy, const Scalar> view(const std::vector<Element>& values,
                                                      std::initializer_list<std::size_t> shape) {
  return {values.data(), shape};
}

}  // namespace msbvh::python
