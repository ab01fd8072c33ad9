// Keyword arguments to C++, arrays without a copy. Whatever does not fit is a TypeError or ValueError that
// names the argument, what was found and what is expected.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/inputs.h"

namespace msbvh::python {

// An array that Python owns: C-contiguous, on the CPU, of the very element type. Keeps it alive.
using AnyArray = nanobind::ndarray<nanobind::ro, nanobind::device::cpu>;

inline constexpr std::size_t kAnySize = std::size_t(-1);

// `values` must be an array of Scalar whose shape is `shape`, where kAnySize stands for any number.
template <typename Scalar>
AnyArray checked_array(nanobind::handle values, std::string_view name,
                       std::initializer_list<std::size_t> shape);

extern template AnyArray checked_array<float>(nanobind::handle, std::string_view,
                                              std::initializer_list<std::size_t>);
extern template AnyArray checked_array<double>(nanobind::handle, std::string_view,
                                               std::initializer_list<std::size_t>);
extern template AnyArray checked_array<int>(nanobind::handle, std::string_view,
                                            std::initializer_list<std::size_t>);

// The elements of a checked array, as Elements laid out one after the other (Vec3f over float32[N, 3]).
template <typename Element>
std::span<const Element> elements(const AnyArray& array) {
  return {static_cast<const Element*>(array.data()), array.nbytes() / sizeof(Element)};
}

// TypeError: what `name` is and what was expected.
[[noreturn]] void wrong_type(std::string_view name, nanobind::handle found, std::string_view expected);

template <typename T>
T value_from(nanobind::handle object, std::string_view name, std::string_view expected) {
  T result;
  if (!nanobind::try_cast(object, result)) wrong_type(name, object, expected);
  return result;
}

// Arrays that spans point into; they live as long as this object. None stands for an empty one.
class Borrowed {
 public:
  std::span<const int> ints(nanobind::handle values, std::string_view name);
  std::span<const double> doubles(nanobind::handle values, std::string_view name);
  std::span<const float> scalars(nanobind::handle values, std::string_view name);
  std::span<const Vec3f> vectors(nanobind::handle values, std::string_view name);
  // A list of (time01, values); one of (None, values) is timeless: authored, but not as time samples.
  translate::ArraySamples samples(nanobind::handle list, std::string_view name, bool held);
  translate::QuaternionSamples quaternions(nanobind::handle list, std::string_view name, bool held);
  // (interpolation, values or a list of (time, values), indices or None), or None.
  template <typename T>
  translate::PrimvarInput<T> primvar(nanobind::handle given, std::string_view name);
  template <typename T>
  void primvar_samples(nanobind::handle list, std::string_view name, translate::PrimvarInput<T>& primvar);

  const AnyArray& keep(AnyArray array);

 private:
  template <typename T>
  std::span<const T> floats(nanobind::handle values, std::string_view name);

  std::vector<AnyArray> kept_;
};

extern template translate::PrimvarInput<Vec3f> Borrowed::primvar(nanobind::handle, std::string_view);
extern template translate::PrimvarInput<float> Borrowed::primvar(nanobind::handle, std::string_view);
extern template void Borrowed::primvar_samples(nanobind::handle, std::string_view,
                                               translate::PrimvarInput<Vec3f>&);

// Instants [begin, end) from float64[K, 2], or None.
std::optional<std::vector<translate::VisibleInterval>> visible_from(nanobind::handle given);

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
    return value_from<T>(required(name), name, expected);
  }
  // `fallback` where it is None or not given.
  template <typename T>
  T value_or(const char* name, const T& fallback, const char* expected) {
    return optional(name).is_none() ? fallback : value<T>(name, expected);
  }
  // Empty where it is None or not given. The array lives as long as this object.
  std::span<const int> ints(const char* name) { return borrowed_.ints(optional(name), name); }
  std::span<const double> times(const char* name) { return borrowed_.doubles(required(name), name); }
  std::vector<translate::Matrix4d> matrices(const char* name, std::size_t count);
  std::optional<std::vector<double>> optional_times(const char* name);
  Borrowed& borrowed() { return borrowed_; }
  const AnyArray& keep(AnyArray array) { return borrowed_.keep(std::move(array)); }
  // TypeError for arguments that nobody took.
  void expect_no_more() const;

  [[noreturn]] void fail(const char* name, nanobind::handle found, const char* expected) const {
    wrong_type(name, found, expected);
  }

 private:
  const nanobind::kwargs& keywords_;
  const char* function_;
  std::vector<std::string> taken_;
  Borrowed borrowed_;
};

}  // namespace msbvh::python
