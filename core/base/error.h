// The one exception type that leaves the library.
#pragma once

#include <stdexcept>
#include <string>

namespace msbvh {

// The scene or the settings are wrong. what() is one line that names the prim (or setting) and the attribute,
// what was found and what is expected.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

// The caller asked to stop; nothing is wrong with the scene.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace msbvh
