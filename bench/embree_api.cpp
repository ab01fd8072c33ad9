#include "bench/embree_api.h"

#include <dlfcn.h>
#include <filesystem>

namespace msbvh::bench::embree {
namespace {

namespace fs = std::filesystem;

// The wheel adds a hash to its libraries' names.
fs::path library_in(const fs::path& folder, const std::string& prefix) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().starts_with(prefix)) return entry.path();
  }
  return {};
}

// By DEEPBIND Embree finds the TBB of its wheel, also in a process that has loaded another one.
void* opened(const fs::path& folder, const std::string& prefix, std::string& failure) {
  const fs::path path = library_in(folder, prefix);
  if (path.empty()) {
    failure = folder.string() + ": found no " + prefix + "*; expected the libraries of the wheel embreex";
    return nullptr;
  }
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
  if (!library) failure = dlerror();
  return library;
}

}  // namespace

std::string load_api(const std::string& folder, Api& api) {
  std::string failure;
  if (!opened(folder, "libtbb", failure)) return failure;
  void* library = opened(folder, "libembree4", failure);
  if (!library) return failure;
  const auto find = [&](auto& function, const char* name) {
    void* found = dlsym(library, name);
    if (!found) failure = std::string("Embree's library has no ") + name;
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
  };
#define MSBVH_FIND(name) find(api.name, #name)
  MSBVH_FIND(rtcNewDevice);
  MSBVH_FIND(rtcReleaseDevice);
  MSBVH_FIND(rtcGetDeviceProperty);
  MSBVH_FIND(rtcGetDeviceError);
  MSBVH_FIND(rtcSetDeviceMemoryMonitorFunction);
  MSBVH_FIND(rtcNewScene);
  MSBVH_FIND(rtcReleaseScene);
  MSBVH_FIND(rtcSetSceneBuildQuality);
  MSBVH_FIND(rtcSetSceneFlags);
  MSBVH_FIND(rtcCommitScene);
  MSBVH_FIND(rtcNewGeometry);
  MSBVH_FIND(rtcReleaseGeometry);
  MSBVH_FIND(rtcCommitGeometry);
  MSBVH_FIND(rtcAttachGeometry);
  MSBVH_FIND(rtcSetGeometryBuildQuality);
  MSBVH_FIND(rtcSetGeometryTimeStepCount);
  MSBVH_FIND(rtcSetSharedGeometryBuffer);
  MSBVH_FIND(rtcSetGeometryInstancedScene);
  MSBVH_FIND(rtcSetGeometryTransform);
  MSBVH_FIND(rtcIntersect1);
  MSBVH_FIND(rtcOccluded1);
  MSBVH_FIND(rtcIntersect16);
  MSBVH_FIND(rtcOccluded16);
#undef MSBVH_FIND
  return failure;
}

}  // namespace msbvh::bench::embree
