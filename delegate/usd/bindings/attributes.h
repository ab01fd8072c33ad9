// Classes whose objects are Python objects under names, None where nothing is given: inputs of the
// translator, set attribute by attribute, and looked at when they are handed down.
#pragma once

#include <cstddef>
#include <nanobind/nanobind.h>
#include <string>
#include <utility>

#include "delegate/usd/bindings/arguments.h"

namespace msbvh::python {

template <typename Object>
struct Attribute {
  const char* name;
  nanobind::object Object::*object;
};

template <typename Object, std::size_t kCount>
void set_to_none(Object& object, const Attribute<Object> (&attributes)[kCount]) {
  for (const Attribute<Object>& attribute : attributes) object.*attribute.object = nanobind::none();
}

template <typename Object, std::size_t kCount>
void bind_attributes(nanobind::module_& m, const char* name, const Attribute<Object> (&attributes)[kCount]) {
  nanobind::class_<Object> bound(m, name);
  bound.def(nanobind::init<>()).def("copy", [](const Object& object) { return object; });
  for (const Attribute<Object>& attribute : attributes) {
    nanobind::object Object::*member = attribute.object;
    bound.def_prop_rw(
        attribute.name, [member](const Object& object) { return object.*member; },
        [member](Object& object, nanobind::object value) { object.*member = std::move(value); },
        nanobind::for_setter(nanobind::arg("value").none()));
  }
}

// Leaves `to` as it is where nothing is given.
template <typename T>
void take(T& to, const nanobind::object& given, const char* name, const char* expected) {
  if (!given.is_none()) to = value_from<T>(given, name, expected);
}

// TypeError where nothing is given. `type` stands in the message.
inline const nanobind::object& required(const nanobind::object& given, const char* type, const char* name) {
  if (given.is_none()) throw nanobind::type_error((std::string(type) + ": found no " + name).c_str());
  return given;
}

}  // namespace msbvh::python
