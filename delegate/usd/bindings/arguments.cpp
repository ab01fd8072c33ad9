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
AnyArray checked_array(nb::handle values, std::string_view name, std::initializer_list<std::size_t> shape) {
  const auto complaint = [&](const std::string& found) {
    return std::string(name) + ": found " + found + "; expected a C-contiguous " + scalar_name<Scalar>() +
           " array " + bracketed(shape);
  };
  AnyArray array;
  if (!nb::try_cast(values, array, false) || array.dtype() != nb::dtype<Scalar>()) {
    throw nb::type_error(complaint(description(values)).c_str());
  }
  if (!fits(array, shape)) throw nb::value_error(complaint(description(values)).c_str());
  if (!is_c_contiguous(array)) throw nb::value_error(complaint("an array with other strides").c_str());
  return array;
}

template AnyArray checked_array<float>(nb::handle, std::string_view, std::initializer_list<std::size_t>);
template AnyArray checked_array<double>(nb::handle, std::string_view, std::initializer_list<std::size_t>);
template AnyArray checked_array<int>(nb::handle, std::string_view, std::initializer_list<std::size_t>);

void wrong_type(std::string_view name, nb::handle found, std::string_view expected) {
  const std::string message = std::string(name) + ": found " + description(found) + "; expected ";
  throw nb::type_error((message + std::string(expected)).c_str());
}

const AnyArray& Borrowed::keep(AnyArray array) {
  kept_.push_back(std::move(array));
  return kept_.back();
}

std::span<const int> Borrowed::ints(nb::handle values, std::string_view name) {
  if (values.is_none()) return {};
  return elements<int>(keep(checked_array<int>(values, name, {kAnySize})));
}

std::span<const double> Borrowed::doubles(nb::handle values, std::string_view name) {
  if (values.is_none()) return {};
  return elements<double>(keep(checked_array<double>(values, name, {kAnySize})));
}

std::span<const float> Borrowed::scalars(nb::handle values, std::string_view name) {
  if (values.is_none()) return {};
  return elements<float>(keep(checked_array<float>(values, name, {kAnySize})));
}

std::span<const Vec3f> Borrowed::vectors(nb::handle values, std::string_view name) {
  return elements<Vec3f>(keep(checked_array<float>(values, name, {kAnySize, 3})));
}

template <>
std::span<const Vec3f> Borrowed::floats(nb::handle values, std::string_view name) {
  return vectors(values, name);
}

template <>
std::span<const float> Borrowed::floats(nb::handle values, std::string_view name) {
  return scalars(values, name);
}

namespace {

std::string part_name(std::string_view name, std::size_t index) {
  return std::string(name) + "[" + std::to_string(index) + "][1]";
}

// values(time01, timeless, array, its index) for each item.
template <typename Values>
void for_samples(nb::handle list, std::string_view name, std::string_view expected, const Values& values) {
  if (list.is_none()) return;
  if (!nb::isinstance<nb::sequence>(list)) wrong_type(name, list, expected);
  std::size_t index = 0;
  for (const nb::handle item : list) {
    if (!nb::isinstance<nb::tuple>(item) || nb::len(item) != 2) wrong_type(name, item, expected);
    const nb::object time = item[0];
    double time01 = 0.0;
    if (!time.is_none() && !nb::try_cast(time, time01)) wrong_type(name, item, expected);
    values(time01, time.is_none(), nb::object(item[1]), index++);
  }
}

}  // namespace

translate::ArraySamples Borrowed::samples(nb::handle list, std::string_view name, bool held) {
  translate::ArraySamples result{{}, held};
  for_samples(list, name, "a list of (time, float32[N, 3])",
              [&](double time01, bool timeless, const nb::object& array, std::size_t index) {
                result.samples.push_back({time01, vectors(array, part_name(name, index))});
                result.timeless = timeless;
              });
  return result;
}

translate::QuaternionSamples Borrowed::quaternions(nb::handle list, std::string_view name, bool held) {
  translate::QuaternionSamples result{{}, held};
  for_samples(
      list, name, "a list of (time, float32[N, 4])",
      [&](double time01, bool timeless, const nb::object& array, std::size_t index) {
        const AnyArray& kept = keep(checked_array<float>(array, part_name(name, index), {kAnySize, 4}));
        result.samples.push_back({time01, elements<translate::Quatf>(kept)});
        result.timeless = timeless;
      });
  return result;
}

// The one in force at the shutter's centre stands for the frame's.
template <typename T>
void Borrowed::primvar_samples(nb::handle list, std::string_view name, translate::PrimvarInput<T>& primvar) {
  for_samples(list, name, "(time, array) for each sample",
              [&](double time01, bool, const nb::object& array, std::size_t index) {
                const std::string part = std::string(name) + "[1][" + std::to_string(index) + "][1]";
                primvar.samples.push_back({time01, floats<T>(array, part)});
                const bool is_first = primvar.samples.size() == 1;
                if (is_first || time01 <= 0.5) primvar.values = primvar.samples.back().values;
              });
}

template <typename T>
translate::PrimvarInput<T> Borrowed::primvar(nb::handle given, std::string_view name) {
  translate::PrimvarInput<T> primvar;
  if (given.is_none()) return primvar;
  if (!nb::isinstance<nb::tuple>(given) || nb::len(given) != 3 ||
      !nb::try_cast(given[0], primvar.interpolation)) {
    wrong_type(name, given, "(interpolation, values, indices or None)");
  }
  const nb::object values = given[1], indices = given[2];
  if (nb::isinstance<nb::list>(values)) {
    primvar_samples(values, name, primvar);
  } else {
    primvar.values = floats<T>(values, std::string(name) + "[1]");
  }
  primvar.indices = ints(indices, std::string(name) + "[2]");
  return primvar;
}

template translate::PrimvarInput<Vec3f> Borrowed::primvar(nb::handle, std::string_view);
template translate::PrimvarInput<float> Borrowed::primvar(nb::handle, std::string_view);
template void Borrowed::primvar_samples(nb::handle, std::string_view, translate::PrimvarInput<Vec3f>&);

std::optional<std::vector<translate::VisibleInterval>> visible_from(nb::handle given) {
  if (given.is_none()) return std::nullopt;
  const AnyArray array = checked_array<double>(given, "visible", {kAnySize, 2});
  const std::span<const translate::VisibleInterval> all = elements<translate::VisibleInterval>(array);
  return std::vector<translate::VisibleInterval>(all.begin(), all.end());
}

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

void Arguments::expect_no_more() const {
  for (const auto& [key, value] : keywords_) {
    const std::string name = nb::cast<std::string>(key);
    if (std::find(taken_.begin(), taken_.end(), name) == taken_.end()) {
      throw nb::type_error((std::string(function_) + "() has no keyword argument " + name).c_str());
    }
  }
}

}  // namespace msbvh::python
