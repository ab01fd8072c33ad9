// The keywords of Translator.add_light.
#pragma once

#include <nanobind/nanobind.h>

#include "delegate/translate/translator.h"

namespace msbvh::python {

// Raises TypeError or ValueError, which names the keyword, what was found and what is expected.
void add_light(translate::Translator& translator, const nanobind::kwargs& keywords);

}  // namespace msbvh::python
