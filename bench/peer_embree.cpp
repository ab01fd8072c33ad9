// Embree as a peer: high build quality, one closest-hit or any-hit query a ray, robust or not.
#include <atomic>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "bench/peer.h"

namespace msbvh::bench {
namespace {

class Embree : public Peer {
 public:
  Embree(const PeerScene& scene, unsigned threads, bool robust) : input_(scene), robust_(robust) {
    const std::string config = "threads=" + std::to_string(threads);
    device_ = rtcNewDevice(config.c_str());
    if (!device_) throw std::runtime_error("bench: Embree made no device");
    rtcSetDeviceMemoryMonitorFunction(device_, &count_bytes, this);
  }
  ~Embree() override {
    for (const RTCScene object : objects_) rtcReleaseScene(object);
    if (scene_) rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void build() override {
    for (const std::vector<PeerMesh>& meshes : input_.objects) {
      RTCScene object = make_scene(meshes);
      rtcCommitScene(object);
      objects_.push_back(object);
    }
    scene_ = make_scene(input_.world);
    for (const PeerInstance& instance : input_.instances) attach(instance);
    rtcCommitScene(scene_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      throw std::runtime_error("bench: Embree's error " + std::to_string(error));
    }
  }

  std::uint64_t bytes() const override {
    std::uint64_t sum = static_cast<std::uint64_t>(bytes_.load());
    for (const PeerMesh& mesh : input_.world) sum += vertex_bytes(mesh);
    for (const std::vector<PeerMesh>& object : input_.objects) {
      for (const PeerMesh& mesh : object) sum += vertex_bytes(mesh);
    }
    return sum;
  }

  void intersect(const Ray* rays, std::size_t count, float* t) const override {
    for (std::size_t i = 0; i < count; ++i) {
      RTCRayHit query;
      query.ray = converted(rays[i]);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
      rtcIntersect1(scene_, &query, nullptr);
#else
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene_, &context, &query);
#endif
      t[i] = query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kInfinity : query.ray.tfar;
    }
  }

  void occluded(const Ray* rays, std::size_t count, float* t) const override {
    for (std::size_t i = 0; i < count; ++i) {
      RTCRay query = converted(rays[i]);
#if RTC_VERSION_MAJOR >= 4
      rtcOccluded1(scene_, &query, nullptr);
#else
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcOccluded1(scene_, &context, &query);
#endif
      t[i] = query.tfar < 0.0f ? 0.0f : kInfinity;
    }
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  static bool count_bytes(void* self, ssize_t bytes, bool) {
    static_cast<Embree*>(self)->bytes_ += bytes;
    return true;
  }

  // Leaves of still, robust scenes hold the vertices; those of moving ones index them.
  static std::uint64_t vertex_bytes(const PeerMesh& mesh) {
    return mesh.keys > 1 ? std::uint64_t(mesh.keys) * mesh.vertices * sizeof(Vec3f) : 0;
  }

  static RTCRay converted(const Ray& ray) {
    RTCRay query;
    query.org_x = ray.org.x;
    query.org_y = ray.org.y;
    query.org_z = ray.org.z;
    query.tnear = ray.tnear;
    query.dir_x = ray.dir.x;
    query.dir_y = ray.dir.y;
    query.dir_z = ray.dir.z;
    query.time = ray.time;
    query.tfar = ray.tfar;
    query.mask = ~0u;
    query.id = 0;
    query.flags = 0;
    return query;
  }

  RTCScene make_scene(const std::vector<PeerMesh>& meshes) {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene, robust_ ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    for (const PeerMesh& mesh : meshes) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
      rtcSetGeometryTimeStepCount(geometry, mesh.keys);
      const std::size_t key_bytes = std::size_t(mesh.vertices) * sizeof(Vec3f);
      for (std::uint32_t key = 0; key < mesh.keys; ++key) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, key, RTC_FORMAT_FLOAT3, mesh.positions,
                                   key * key_bytes, sizeof(Vec3f), mesh.vertices);
      }
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles, 0,
                                 3 * sizeof(std::uint32_t), mesh.triangle_count);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    return scene;
  }

  void attach(const PeerInstance& instance) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, objects_[instance.object]);
    rtcSetGeometryTimeStepCount(geometry, instance.keys);
    static_assert(sizeof(Affine3f) == 12 * sizeof(float));
    for (std::uint32_t key = 0; key < instance.keys; ++key) {
      rtcSetGeometryTransform(geometry, key, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                              &instance.world_from_object[key]);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  const PeerScene& input_;
  const bool robust_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> objects_;
  std::atomic<std::int64_t> bytes_ = 0;
};

}  // namespace
}  // namespace msbvh::bench

extern "C" {

std::uint32_t msbvh_peer_abi() { return msbvh::bench::kPeerAbi; }

const char* msbvh_peer_name() { return "Embree " RTC_VERSION_STRING; }

msbvh::bench::Peer* msbvh_peer_make(const msbvh::bench::PeerScene& scene, unsigned threads, bool robust) {
  return new msbvh::bench::Embree(scene, threads, robust);
}

}  // extern "C"
