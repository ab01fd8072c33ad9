// What the peer calls of Embree 4's C interface, declared by ourselves after its published API documentation:
// the library comes from a Python wheel, which has no headers. Names are Embree's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <sys/types.h>

namespace msbvh::bench::embree {

// Handles are opaque pointers, enumerations are ints.
using Device = void*;
using Scene = void*;
using Geometry = void*;

inline constexpr int kVersionProperty =
    0;  // RTC_DEVICE_PROPERTY_VERSION: major * 10000 + minor * 100 + patch
inline constexpr int kNativeRay8Property = 33;
inline constexpr int kNativeRay16Property = 34;
inline constexpr int kTriangleGeometry = 0;
inline constexpr int kRoundBezierGeometry = 24;
inline constexpr int kFlatBezierGeometry = 25;
inline constexpr int kSphereGeometry = 50;
inline constexpr int kInstanceGeometry = 121;
inline constexpr int kIndexBuffer = 0;
inline constexpr int kVertexBuffer = 1;
inline constexpr int kUint = 0x5001;
inline constexpr int kUint3 = 0x5003;
inline constexpr int kFloat3 = 0x9003;
inline constexpr int kFloat4 = 0x9004;
inline constexpr int kFloat3x4ColumnMajor = 0x9234;
inline constexpr int kHighQuality = 2;
inline constexpr int kRobustScene = 1 << 2;
inline constexpr int kIncoherent = 0;
inline constexpr int kCoherent = 1 << 16;
inline constexpr unsigned kAllFeatures = 0xffffffffu;
inline constexpr unsigned kNoId = 0xffffffffu;

// One ray or a packet of N, each quantity in a row.
template <std::size_t N>
struct alignas(N == 1 ? 16 : 4 * N) RayN {
  float org_x[N], org_y[N], org_z[N], tnear[N];
  float dir_x[N], dir_y[N], dir_z[N], time[N];
  float tfar[N];  // the hit's distance; -infinity where a ray is occluded
  unsigned mask[N], id[N], flags[N];
};
template <std::size_t N>
struct alignas(N == 1 ? 16 : 4 * N) HitN {
  float normal_x[N], normal_y[N], normal_z[N], u[N], v[N];
  unsigned primitive[N], geometry[N], instance[N];
  unsigned instance_primitive[N];  // read and written by builds with instance arrays only, and then the last
};
template <std::size_t N>
struct RayHitN {
  RayN<N> ray;
  HitN<N> hit;
};
static_assert(sizeof(RayN<1>) == 48 && sizeof(RayN<16>) == 768);

// RTCIntersectArguments and RTCOccludedArguments, which have the same layout.
struct QueryArguments {
  int flags = kIncoherent;
  unsigned features = kAllFeatures;
  void* context = nullptr;
  void* filter = nullptr;
  void* user_query = nullptr;
  float min_width_distance_factor = 0.0f;  // read by builds with RTC_MIN_WIDTH only
};

// The functions, found in the library.
struct Api {
  Device (*rtcNewDevice)(const char* config);
  void (*rtcReleaseDevice)(Device);
  ssize_t (*rtcGetDeviceProperty)(Device, int property);
  int (*rtcGetDeviceError)(Device);
  void (*rtcSetDeviceMemoryMonitorFunction)(Device, bool (*)(void* user, ssize_t bytes, bool post),
                                            void* user);
  Scene (*rtcNewScene)(Device);
  void (*rtcReleaseScene)(Scene);
  void (*rtcSetSceneBuildQuality)(Scene, int quality);
  void (*rtcSetSceneFlags)(Scene, int flags);
  void (*rtcCommitScene)(Scene);
  Geometry (*rtcNewGeometry)(Device, int type);
  void (*rtcReleaseGeometry)(Geometry);
  void (*rtcCommitGeometry)(Geometry);
  unsigned (*rtcAttachGeometry)(Scene, Geometry);
  void (*rtcSetGeometryBuildQuality)(Geometry, int quality);
  void (*rtcSetGeometryTimeStepCount)(Geometry, unsigned count);
  void (*rtcSetSharedGeometryBuffer)(Geometry, int buffer, unsigned slot, int format, const void*,
                                     std::size_t offset, std::size_t stride, std::size_t count);
  void (*rtcSetGeometryInstancedScene)(Geometry, Scene);
  void (*rtcSetGeometryTransform)(Geometry, unsigned key, int format, const void* transform);
  void (*rtcIntersect1)(Scene, RayHitN<1>*, QueryArguments*);
  void (*rtcOccluded1)(Scene, RayN<1>*, QueryArguments*);
  void (*rtcIntersect16)(const int* valid, Scene, RayHitN<16>*, QueryArguments*);
  void (*rtcOccluded16)(const int* valid, Scene, RayN<16>*, QueryArguments*);
};

// Loads libembree4 and the libtbb that it was linked with from the wheel's folder of libraries. Returns what
// failed; empty: nothing.
std::string load_api(const std::string& folder, Api& api);

}  // namespace msbvh::bench::embree
