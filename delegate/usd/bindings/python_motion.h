// A Python object as translate::MotionSource.
#pragma once

#include <algorithm>
#include <cstdint>
#include <nanobind/nanobind.h>
#include <nanobind/stl/vector.h>
#include <span>
#include <vector>

#include "delegate/translate/sample/motion_source.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"

namespace msbvh::python {

// int64[N].
inline nanobind::object index_array(std::span<const std::uint32_t> which) {
  return owned_array<std::int64_t>(std::vector<std::int64_t>(which.begin(), which.end()), {which.size()});
}

// With the same members; evaluate() gives float64[T, M, 4, 4]. May be called without the GIL.
class PythonMotion : public translate::MotionSource {
 public:
  explicit PythonMotion(nanobind::handle motion) : motion_(motion) {}

  std::size_t count() const override { return get<std::size_t>("count"); }
  bool still() const override { return get<bool>("still"); }
  std::vector<double> breakpoints01() const override { return get<std::vector<double>>("breakpoints01"); }
  translate::Turns turns(std::uint32_t which) const override {
    const nanobind::gil_scoped_acquire gil;
    return nanobind::cast<translate::Turns>(motion_.attr("turns")(which));
  }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<translate::Matrix4d> out) const override {
    const nanobind::gil_scoped_acquire gil;
    const nanobind::object times = nanobind::cast(std::vector<double>(times01.begin(), times01.end()));
    const nanobind::object found = motion_.attr("evaluate")(times, index_array(which));
    const AnyArray array = checked_array<double>(found, "evaluate()", {times01.size(), which.size(), 4, 4});
    std::ranges::copy(elements<translate::Matrix4d>(array), out.begin());
  }

 private:
  template <typename T>
  T get(const char* name) const {
    const nanobind::gil_scoped_acquire gil;
    return nanobind::cast<T>(motion_.attr(name));
  }

  nanobind::handle motion_;
};

}  // namespace msbvh::python
