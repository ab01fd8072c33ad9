// Keyword arguments to C++, arrays without a copy. Whatever does not fit is a TypeError or ValueError that
// names the argument, what was found and what is expected.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/inputs.h"

namespace msbvh::python {

// An array that Python owns: C-contiguous, on the CPU, of the very element type. Keeps it alive.
using AnyArray = nanobind::ndarray<nanobind::ro, nanobind::device::cpu>;

inline constexpr std::size_t kAnySize = std::size_t(-1);

// `values` must be an array of Scalar whose shape is `shape`, where kAnySize stands for any number.
template <typename Scalar>
AnyArray checked_array(nanobind::handle values, const std::string& name,
                       std::initializer_list<std::size_t> shape);

extern template AnyArray checked_array<float>(nanobind::handle, const std::string&,
                                              std::initializer_list<std::size_t>);
extern template AnyArray checked_array<double>(nanobind::handle, const std::string&,
                                               std::initializer_list<std::size_t>);
extern template AnyArray checked_array<int>(nanobind::handle, const std::string&,
                                            std::initializer_list<std::size_t>);

// The elements of a checked array, as Elements laid out one after the other (Vec3f over float32[N, 3]).
template <typename Element>
std::span<const Element> elements(const AnyArray& array) {
  return {static_cast<const Element*>(array.data()), array.nbytes() / sizeof(Element)};
}

// The keyword arguments of one call, each taken once.
class Arguments {
 public:
  // `function` stands in the messages.
  Arguments(const nanobind::kwargs& keywords, const char* function)
      : keywords_(keywords), function_(function) {}

  // None where it is not given.
  nanobind::object optional(const char* name);
  // TypeError where it is not given.
  nanobind::object required(const char* name);
  template <typename T>
  T value(const char* name, const char* expected) {
    const nanobind::object object = required(name);
    T result;
    if (!nanobind::try_cast(object, result)) fail(name, object, expected);
    return result;
  }
  // `fallback` where it is None or not given.
  template <typename T>
  T value_or(const char* name, const T& fallback, const char* expected) {
    return optional(name).is_none() ? fallback : value<T>(name, expected);
  }
  // Empty where it is None or not given. The array lives as long as this object.
  std::span<const int> ints(const char* name);
  std::span<const double> times(const char* name);
  std::vector<translate::Matrix4d> matrices(const char* name, std::size_t count);
  std::optional<std::vector<double>> optional_times(const char* name);
  // A list of (time01, values); one of (None, values) is timeless: authored, but not as time samples.
  translate::ArraySamples samples(const char* name, bool held);
  translate::QuaternionSamples quaternions(const char* name, bool held);
  template <typename Element>
  std::span<const Element> floats(nanobind::handle values, const std::string& name);

  const AnyArray& keep(AnyArray array);
  // TypeError for arguments that nobody took.
  void expect_no_more() const;

  [[noreturn]] void fail(const char* name, nanobind::handle found, const char* expected) const;

 private:
  template <typename Values>
  void for_samples(const char* name, const char* expected, const Values& values);

  const nanobind::kwargs& keywords_;
  const char* function_;
  std::vector<std::string> taken_;
  std::vector<AnyArray> kept_;
};

// Vec3f over float32[N, 3], float over float32[N].
template <>
std::span<const Vec3f> Arguments::floats<Vec3f>(nanobind::handle values, const std::string& name);
template <>
std::span<const float> Arguments::floats<float>(nanobind::handle values, const std::string& name);

}  // namespace msbvh::python
