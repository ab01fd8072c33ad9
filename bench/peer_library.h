// A peer's shared library, loaded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/peer.h"

namespace msbvh::bench {

class PeerLibrary {
 public:
  // `folder` holds the ray tracer's own libraries. All stay loaded for the life of the process. Throws Error
  // where one cannot be loaded or is of another version.
  PeerLibrary(const std::string& path, const std::string& folder);

  const char* name() const { return name_(); }
  // The ways in which it can be asked: "single" and others.
  const std::vector<std::string>& modes() const { return modes_; }
  // Borrows the scene.
  std::unique_ptr<Peer> make(const PeerScene& scene, unsigned threads, bool robust) const {
    return std::unique_ptr<Peer>(make_(scene, threads, robust));
  }

 private:
  const char* (*name_)() = nullptr;
  std::vector<std::string> modes_;
  Peer* (*make_)(const PeerScene&, unsigned, bool) = nullptr;
};

}  // namespace msbvh::bench
