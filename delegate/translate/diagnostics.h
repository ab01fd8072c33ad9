// What a translation has to say about its input: the one place where messages are collected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace msbvh::translate {

enum class Severity : std::uint8_t {
  kNote,     // nothing is lost
  kWarning,  // rendered, but something was left out or approximated
  kError     // the prim was not rendered
};

// Names the prim, the attribute, what was found and what was expected, in one line.
struct Diagnostic {
  Severity severity;
  std::string path;
  std::string attribute;
  std::string message;
  // What many prims may have in common: front-ends tell it once for all of them.
  bool in_common = false;
};

// Parts written one after the other: numbers in the fewest digits that tell them apart at single precision.
template <typename... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream out;
  out.precision(9);
  (out << ... << parts);
  return out.str();
}

// A sample's time for a person who knows the stage and not our time remap.
inline std::string at_shutter_time(double time01) {
  return message("at shutter time ", time01, " (0 is the opening, 1 the closing)");
}

// The messages about one prim, or about a part of it that it can be rendered without.
class PrimLog {
 public:
  PrimLog(std::vector<Diagnostic>& all, std::string path) : all_(&all), path_(std::move(path)) {}

  // Checks that fail on this log leave out the part only: their messages are warnings that say so.
  PrimLog of_optional_part() const {
    PrimLog log = *this;
    log.optional_ = true;
    return log;
  }
  // The same for a part that is a prim of its own: messages name it.
  PrimLog of_part(std::string path) const {
    PrimLog log = of_optional_part();
    log.path_ = std::move(path);
    return log;
  }
  // For checks on another prim that belongs to this one; an empty path: on this one.
  PrimLog of_prim(const std::string& path) const {
    PrimLog log = *this;
    if (!path.empty()) log.path_ = path;
    return log;
  }
  const std::string& path() const { return path_; }

  void warn(const std::string& attribute, const std::string& message) {
    all_->push_back({Severity::kWarning, path_, attribute, message});
  }
  // For what many prims may have in common.
  void warn_in_common(const std::string& attribute, const std::string& message) {
    all_->push_back({Severity::kWarning, path_, attribute, message, true});
  }
  void note_in_common(const std::string& attribute, const std::string& message) {
    all_->push_back({Severity::kNote, path_, attribute, message, true});
  }
  // What is checked cannot be used. Returns false, so that a check can end with `return log.reject(...)`.
  bool reject(const std::string& attribute, const std::string& message) {
    if (optional_) {
      warn(attribute, message + "; it is left out");
    } else {
      all_->push_back({Severity::kError, path_, attribute, message});
      rejected_ = true;
    }
    return false;
  }
  // How many messages there are, of all prims.
  std::size_t said() const { return all_->size(); }
  // Takes back those from the one number of said() to the other.
  void take_back(std::size_t begin, std::size_t end) {
    all_->erase(all_->begin() + std::ptrdiff_t(begin), all_->begin() + std::ptrdiff_t(end));
  }
  // Whether the prim itself, not only a part of it, cannot be used.
  bool rejected() const { return rejected_; }

 private:
  std::vector<Diagnostic>* all_;
  std::string path_;
  bool optional_ = false;
  bool rejected_ = false;
};

}  // namespace msbvh::translate
