#include "bench/peer_library.h"

#include <dlfcn.h>

#include "core/base/error.h"

namespace msbvh::bench {
namespace {

void* symbol(void* library, const std::string& path, const char* name) {
  void* found = dlsym(library, name);
  if (!found)
    throw Error("bench: " + path + ": found no " + name + "; expected a peer built with this msbvh");
  return found;
}

}  // namespace

PeerLibrary::PeerLibrary(const std::string& path, const std::string& folder) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Error("bench: the peer cannot be loaded: " + std::string(dlerror()));
  const auto abi = reinterpret_cast<std::uint32_t (*)()>(symbol(library, path, "msbvh_peer_abi"));
  if (abi() != kPeerAbi) throw Error("bench: " + path + " is of another version; build it anew");
  const auto open = reinterpret_cast<const char* (*)(const char*)>(symbol(library, path, "msbvh_peer_open"));
  if (const char* failure = open(folder.c_str()))
    throw Error("bench: the peer cannot be loaded: " + std::string(failure));
  const auto modes = reinterpret_cast<const char* const* (*)()>(symbol(library, path, "msbvh_peer_modes"));
  for (const char* const* mode = modes(); *mode; ++mode) modes_.emplace_back(*mode);
  name_ = reinterpret_cast<decltype(name_)>(symbol(library, path, "msbvh_peer_name"));
  make_ = reinterpret_cast<decltype(make_)>(symbol(library, path, "msbvh_peer_make"));
}

}  // namespace msbvh::bench
