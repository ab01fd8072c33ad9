// A row of the report as a JSON object.
#pragma once

#include <cmath>
#include <concepts>
#include <sstream>
#include <string>

namespace msbvh::bench {

class JsonRow {
 public:
  void add(const char* key, const std::string& text) {
    std::string escaped;
    for (const char c : text) {
      if (c == '"' || c == '\\') escaped += '\\';
      escaped += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    start(key) << '"' << escaped << '"';
  }
  void add(const char* key, const char* text) { add(key, std::string(text)); }
  void add(const char* key, std::integral auto value) {
    if constexpr (std::same_as<decltype(value), bool>) {
      start(key) << (value ? "true" : "false");
    } else {
      start(key) << value;
    }
  }
  // What is not a number was not measured: null.
  void add(const char* key, double value) {
    if (std::isfinite(value)) {
      start(key) << value;
    } else {
      start(key) << "null";
    }
  }
  std::string text() const { return std::string(1, '{').append(out_.str()).append(1, '}'); }

 private:
  std::ostringstream& start(const char* key) {
    out_.precision(6);
    out_ << (first_ ? "" : ", ") << '"' << key << "\": ";
    first_ = false;
    return out_;
  }

  std::ostringstream out_;
  bool first_ = true;
};

}  // namespace msbvh::bench
