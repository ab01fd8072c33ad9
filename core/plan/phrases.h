// Numbers in the phrases of a plan's reasons.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>

namespace msbvh {

inline std::string phrase(float number, const char* unit) {
  std::ostringstream text;
  text << number << unit;
  return text.str();
}
inline std::string segments_phrase(std::uint32_t segments) {
  return std::to_string(segments) + (segments == 1 ? " segment" : " segments");
}

}  // namespace msbvh
