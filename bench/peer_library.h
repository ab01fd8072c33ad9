// A peer's shared library, loaded.
#pragma once

#include <memory>
#include <string>

#include "bench/peer.h"

namespace msbvh::bench {

class PeerLibrary {
 public:
  // Stays loaded for the life of the process. Throws Error where it cannot be loaded or is of another
  // version.
  explicit PeerLibrary(const std::string& path);

  const char* name() const { return name_(); }
  // Borrows the scene.
  std::unique_ptr<Peer> make(const PeerScene& scene, unsigned threads, bool robust) const {
    return std::unique_ptr<Peer>(make_(scene, threads, robust));
  }

 private:
  const char* (*name_)() = nullptr;
  Peer* (*make_)(const PeerScene&, unsigned, bool) = nullptr;
};

}  // namespace msbvh::bench
