#include "delegate/usd/bindings/arguments.h"

#include <algorithm>
#include <nanobind/stl/string.h>
#include <type_traits>
#include <utility>

namespace nb = nanobind;

namespace msbvh::python {
namespace {

template <typename Scalar>
const char* scalar_name() {
  if (std::is_same_v<Scalar, float>) return "float32";
  return std::is_same_v<Scalar, double> ? "float64" : "int32";
}

std::string bracketed(std::initializer_list<std::size_t> shape) {
  std::string text;
  for (const std::size_t size : shape) {
    text += (text.empty() ? "[" : ", ") + (size == kAnySize ? std::string("*") : std::to_string(size));
  }
  return text + "]";
}

std::string name_of_type(nb::handle object) { return nb::cast<std::string>(object.type().attr("__name__")); }

std::string text_of(const nb::object& object) { return nb::str(object).c_str(); }

// For numpy arrays their element type and shape, for others their type.
std::string description(nb::handle object) {
  if (!nb::hasattr(object, "dtype") || !nb::hasattr(object, "shape")) return name_of_type(object);
  return text_of(object.attr("dtype")) + " array of shape " + text_of(object.attr("shape"));
}

bool fits(const AnyArray& array, std::initializer_list<std::size_t> shape) {
  if (array.ndim() != shape.size()) return false;
  return std::equal(shape.begin(), shape.end(), array.shape_ptr(),
                    [](std::size_t expected, std::int64_t found) {
                      return expected == kAnySize || expected == std::size_t(found);
                    });
}

bool is_c_contiguous(const AnyArray& array) {
  if (array.size() == 0) return true;
  std::int64_t stride = 1;
  for (std::size_t axis = array.ndim(); axis-- > 0;) {
    if (array.shape(axis) != 1 && array.stride(axis) != stride) return false;
    stride *= std::int64_t(array.shape(axis));
  }
  return true;
}

}  // namespace

template <typename Scalar>
AnyArray checked_array(nb::handle values, const std::string& name, std::initializer_list<std::size_t> shape) {
  const std::string expected =
      "; expected a C-contiguous " + std::string(scalar_name<Scalar>()) + " array " + bracketed(shape);
  AnyArray array;
  if (!nb::try_cast(values, array, false) || array.dtype() != nb::dtype<Scalar>()) {
    throw nb::type_error((name + ": found " + description(values) + expected).c_str());
  }
  if (!fits(array, shape)) {
    throw nb::value_error((name + ": found " + description(values) + expected).c_str());
  }
  if (!is_c_contiguous(array)) {
    throw nb::value_error((name + ": found an array with other strides" + expected).c_str());
  }
  return array;
}

template AnyArray checked_array<float>(nb::handle, const std::string&, std::initializer_list<std::size_t>);
template AnyArray checked_array<double>(nb::handle, const std::string&, std::initializer_list<std::size_t>);
template AnyArray checked_array<int>(nb::handle, const std::string&, std::initializer_list<std::size_t>);

nb::object Arguments::optional(const char* name) {
  taken_.emplace_back(name);
  return keywords_.contains(name) ? nb::object(keywords_[name]) : nb::none();
}

nb::object Arguments::required(const char* name) {
  if (!keywords_.contains(name)) {
    throw nb::type_error((std::string(function_) + "() misses the keyword argument " + name).c_str());
  }
  return optional(name);
}

const AnyArray& Arguments::keep(AnyArray array) {
  kept_.push_back(std::move(array));
  return kept_.back();
}

std::span<const int> Arguments::ints(const char* name) {
  const nb::object values = optional(name);
  if (values.is_none()) return {};
  return elements<int>(keep(checked_array<int>(values, name, {kAnySize})));
}

std::span<const double> Arguments::times(const char* name) {
  return elements<double>(keep(checked_array<double>(required(name), name, {kAnySize})));
}

std::vector<translate::Matrix4d> Arguments::matrices(const char* name, std::size_t count) {
  const AnyArray array = checked_array<double>(required(name), name, {count, 4, 4});
  const std::span<const translate::Matrix4d> all = elements<translate::Matrix4d>(array);
  return {all.begin(), all.end()};
}

std::optional<std::vector<double>> Arguments::optional_times(const char* name) {
  if (optional(name).is_none()) return std::nullopt;
  const std::span<const double> values = times(name);
  return std::vector<double>(values.begin(), values.end());
}

// values(time01, timeless, array, the array's name) for each item.
template <typename Values>
void Arguments::for_samples(const char* name, const char* expected, const Values& values) {
  const nb::object list = optional(name);
  if (list.is_none()) return;
  if (!nb::isinstance<nb::sequence>(list)) fail(name, list, expected);
  std::size_t index = 0;
  for (const nb::handle item : list) {
    if (!nb::isinstance<nb::tuple>(item) || nb::len(item) != 2) fail(name, item, expected);
    const nb::object time = item[0];
    double time01 = 0.0;
    if (!time.is_none() && !nb::try_cast(time, time01)) fail(name, item, expected);
    const std::string part = std::string(name) + "[" + std::to_string(index++) + "][1]";
    values(time01, time.is_none(), nb::object(item[1]), part);
  }
}

translate::ArraySamples Arguments::samples(const char* name, bool held) {
  translate::ArraySamples result{{}, held};
  for_samples(name, "a list of (time, float32[N, 3])",
              [&](double time01, bool timeless, const nb::object& array, const std::string& part) {
                result.samples.push_back({time01, floats<Vec3f>(array, part)});
                result.timeless = timeless;
              });
  return result;
}

translate::QuaternionSamples Arguments::quaternions(const char* name, bool held) {
  translate::QuaternionSamples result{{}, held};
  for_samples(name, "a list of (time, float32[N, 4])",
              [&](double time01, bool timeless, const nb::object& array, const std::string& part) {
                const AnyArray& kept = keep(checked_array<float>(array, part, {kAnySize, 4}));
                result.samples.push_back({time01, elements<translate::Quatf>(kept)});
                result.timeless = timeless;
              });
  return result;
}

template <>
std::span<const Vec3f> Arguments::floats<Vec3f>(nb::handle values, const std::string& name) {
  return elements<Vec3f>(keep(checked_array<float>(values, name, {kAnySize, 3})));
}

template <>
std::span<const float> Arguments::floats<float>(nb::handle values, const std::string& name) {
  return elements<float>(keep(checked_array<float>(values, name, {kAnySize})));
}

void Arguments::expect_no_more() const {
  for (const auto& [key, value] : keywords_) {
    const std::string name = nb::cast<std::string>(key);
    if (std::find(taken_.begin(), taken_.end(), name) == taken_.end()) {
      throw nb::type_error((std::string(function_) + "() has no keyword argument " + name).c_str());
    }
  }
}

void Arguments::fail(const char* name, nb::handle found, const char* expected) const {
  throw nb::type_error(
      (std::string(name) + ": found " + description(found) + "; expected " + expected).c_str());
}

}  // namespace msbvh::python
