// What a target may come to: a result that holds, or an Error with a message for a person. Anything else ends
// the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"

// As libFuzzer calls it; the driver (driver.cpp) does the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace msbvh::fuzz {

// A defect.
[[noreturn]] inline void fail(const std::string& what) {
  std::fprintf(stderr, "defect: %s\n", what.c_str());
  std::fflush(stderr);
  std::abort();
}
inline void require(bool holds, const char* what) {
  if (!holds) fail(what);
}

// `part: attribute: found ...; expected ...`, in one line.
inline void require_clear(const std::string& message) {
  const auto has = [&](const char* text) { return message.find(text) != std::string::npos; };
  if (message.find('\n') != std::string::npos || !has(":") || message.size() < 12 || message.size() > 1000) {
    fail("an error that is not one clear line: " + message);
  }
}

// The result, or none where the input is refused in so many words. Other exceptions, and Cancelled, pass.
template <typename Function>
auto accepted(const Function& function) -> std::optional<decltype(function())> {
  try {
    return function();
  } catch (const Error& error) {
    require_clear(error.what());
    return std::nullopt;
  }
}
// Whether it was not refused.
template <typename Function>
bool passes(const Function& function) {
  return accepted([&] {
           function();
           return true;
         })
      .has_value();
}

}  // namespace msbvh::fuzz
