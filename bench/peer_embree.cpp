// Embree 4 as a peer: high build quality, robust or not, asked one ray at a time and in packets of 16.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <immintrin.h>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "bench/embree_api.h"
#include "bench/peer.h"

namespace msbvh::bench {
namespace {

using embree::RayHitN;
using embree::RayN;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr const char* kModes[] = {"single", "packet_coherent", "packet_incoherent", nullptr};
enum Mode : std::size_t { kSingle, kPacketCoherent, kPacketIncoherent };

embree::Api api;

// Embree asks for it: denormals slow it down. Ours never see it: they stand between our own measurements.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 1u << 15, kDenormalsAreZero = 1u << 6;
  const unsigned before_;
};

template <std::size_t N>
void set_ray(RayN<N>& packet, std::size_t i, const Ray& ray) {
  packet.org_x[i] = ray.org.x;
  packet.org_y[i] = ray.org.y;
  packet.org_z[i] = ray.org.z;
  packet.tnear[i] = ray.tnear;
  packet.dir_x[i] = ray.dir.x;
  packet.dir_y[i] = ray.dir.y;
  packet.dir_z[i] = ray.dir.z;
  packet.time[i] = ray.time;
  packet.tfar[i] = ray.tfar;
  packet.mask[i] = ~0u;
  packet.id[i] = 0;
  packet.flags[i] = 0;
}

template <std::size_t N>
void expect_hits(RayHitN<N>& query) {
  std::fill_n(query.hit.geometry, N, embree::kNoId);
  std::fill_n(query.hit.instance, N, embree::kNoId);
}

class EmbreeRays : public PeerRays {
 public:
  EmbreeRays(const Ray* rays, std::size_t count) : count(count), single(count) {
    packets.resize((count + kPeerPacket - 1) / kPeerPacket);
    for (std::size_t i = 0; i < count; ++i) set_ray(single[i], 0, rays[i]);
    for (std::size_t i = 0; i < packets.size() * kPeerPacket; ++i) {
      set_ray(packets[i / kPeerPacket], i % kPeerPacket, rays[std::min(i, count - 1)]);
    }
  }

  const std::size_t count;
  std::vector<RayN<1>> single;
  std::vector<RayN<kPeerPacket>> packets;  // the last one is filled up
};

class Embree : public Peer {
 public:
  Embree(const PeerScene& scene, unsigned threads, bool robust) : input_(scene), robust_(robust) {
    const std::string config = "threads=" + std::to_string(threads);
    device_ = api.rtcNewDevice(config.c_str());
    if (!device_) throw std::runtime_error("bench: Embree made no device");
    api.rtcSetDeviceMemoryMonitorFunction(device_, &count_bytes, this);
  }
  ~Embree() override {
    for (const embree::Scene object : objects_) api.rtcReleaseScene(object);
    if (scene_) api.rtcReleaseScene(scene_);
    api.rtcReleaseDevice(device_);
  }

  void build() override {
    const FlushDenormals flush;
    for (const PeerObject& each : input_.objects) {
      embree::Scene object = make_scene(each);
      api.rtcCommitScene(object);
      objects_.push_back(object);
    }
    scene_ = make_scene(input_.world);
    for (const PeerInstance& instance : input_.instances) attach(instance);
    api.rtcCommitScene(scene_);
    if (const int error = api.rtcGetDeviceError(device_); error != 0) {
      throw std::runtime_error("bench: Embree's error " + std::to_string(error));
    }
  }

  std::uint64_t bytes() const override {
    std::uint64_t sum = static_cast<std::uint64_t>(bytes_.load());
    sum += vertex_bytes(input_.world);
    for (const PeerObject& object : input_.objects) sum += vertex_bytes(object);
    return sum;
  }

  std::unique_ptr<PeerRays> prepare(const Ray* rays, std::size_t count) const override {
    return std::make_unique<EmbreeRays>(rays, count);
  }

  void intersect(std::size_t mode, const PeerRays& rays, std::size_t begin, std::size_t end,
                 float* t) const override {
    const FlushDenormals flush;
    const auto& prepared = static_cast<const EmbreeRays&>(rays);
    mode == kSingle ? intersect_single(prepared, begin, end, t)
                    : intersect_packets(flags_of(mode), prepared, begin, end, t);
  }

  void occluded(std::size_t mode, const PeerRays& rays, std::size_t begin, std::size_t end,
                float* t) const override {
    const FlushDenormals flush;
    const auto& prepared = static_cast<const EmbreeRays&>(rays);
    mode == kSingle ? occluded_single(prepared, begin, end, t)
                    : occluded_packets(flags_of(mode), prepared, begin, end, t);
  }

 private:
  static int flags_of(std::size_t mode) {
    return mode == kPacketCoherent ? embree::kCoherent : embree::kIncoherent;
  }

  void intersect_single(const EmbreeRays& rays, std::size_t begin, std::size_t end, float* t) const {
    embree::QueryArguments arguments;
    for (std::size_t i = begin; i < end; ++i) {
      RayHitN<1> query;
      query.ray = rays.single[i];
      expect_hits(query);
      api.rtcIntersect1(scene_, &query, &arguments);
      *t++ = query.hit.geometry[0] == embree::kNoId ? kInfinity : query.ray.tfar[0];
    }
  }

  void occluded_single(const EmbreeRays& rays, std::size_t begin, std::size_t end, float* t) const {
    embree::QueryArguments arguments;
    for (std::size_t i = begin; i < end; ++i) {
      RayN<1> query = rays.single[i];
      api.rtcOccluded1(scene_, &query, &arguments);
      *t++ = query.tfar[0] < 0.0f ? 0.0f : kInfinity;
    }
  }

  // Calls work(packet, valid, rays in it, t) for each packet of the range.
  template <typename Work>
  static void for_packets(const EmbreeRays& rays, std::size_t begin, std::size_t end, float* t,
                          const Work& work) {
    alignas(64) int valid[kPeerPacket];
    for (std::size_t i = begin; i < end; i += kPeerPacket, t += kPeerPacket) {
      const std::size_t used = std::min(kPeerPacket, end - i);
      for (std::size_t lane = 0; lane < kPeerPacket; ++lane) valid[lane] = lane < used ? -1 : 0;
      work(rays.packets[i / kPeerPacket], valid, used, t);
    }
  }

  void intersect_packets(int flags, const EmbreeRays& rays, std::size_t begin, std::size_t end,
                         float* t) const {
    embree::QueryArguments arguments;
    arguments.flags = flags;
    for_packets(rays, begin, end, t, [&](const auto& packet, const int* valid, std::size_t used, float* out) {
      RayHitN<kPeerPacket> query;
      query.ray = packet;
      expect_hits(query);
      api.rtcIntersect16(valid, scene_, &query, &arguments);
      for (std::size_t lane = 0; lane < used; ++lane) {
        out[lane] = query.hit.geometry[lane] == embree::kNoId ? kInfinity : query.ray.tfar[lane];
      }
    });
  }

  void occluded_packets(int flags, const EmbreeRays& rays, std::size_t begin, std::size_t end,
                        float* t) const {
    embree::QueryArguments arguments;
    arguments.flags = flags;
    for_packets(rays, begin, end, t, [&](const auto& packet, const int* valid, std::size_t used, float* out) {
      RayN<kPeerPacket> query = packet;
      api.rtcOccluded16(valid, scene_, &query, &arguments);
      for (std::size_t lane = 0; lane < used; ++lane) out[lane] = query.tfar[lane] < 0.0f ? 0.0f : kInfinity;
    });
  }

  static bool count_bytes(void* self, ssize_t bytes, bool) {
    static_cast<Embree*>(self)->bytes_ += bytes;
    return true;
  }

  // Leaves of still, robust scenes hold the vertices of triangles; those of moving ones index them, as all
  // leaves of curves and points do.
  static std::uint64_t vertex_bytes(const PeerObject& object) {
    std::uint64_t sum = 0;
    for (const PeerMesh& mesh : object.meshes) {
      if (mesh.keys > 1) sum += std::uint64_t(mesh.keys) * mesh.vertices * sizeof(Vec3f);
    }
    for (const PeerRound& round : object.round)
      sum += std::uint64_t(round.keys) * round.vertex_count * sizeof(RoundVertex);
    return sum;
  }

  embree::Scene make_scene(const PeerObject& object) {
    embree::Scene scene = api.rtcNewScene(device_);
    api.rtcSetSceneBuildQuality(scene, embree::kHighQuality);
    api.rtcSetSceneFlags(scene, robust_ ? embree::kRobustScene : 0);
    for (const PeerMesh& mesh : object.meshes) attach_mesh(mesh, scene);
    for (const PeerRound& round : object.round) attach_round(round, scene);
    return scene;
  }

  embree::Geometry new_geometry(int type, std::uint32_t keys) {
    embree::Geometry geometry = api.rtcNewGeometry(device_, type);
    api.rtcSetGeometryBuildQuality(geometry, embree::kHighQuality);
    api.rtcSetGeometryTimeStepCount(geometry, keys);
    return geometry;
  }
  static void set_vertices(embree::Geometry geometry, int format, const void* vertices, std::size_t size,
                           std::uint32_t count, std::uint32_t keys) {
    for (std::uint32_t key = 0; key < keys; ++key)
      api.rtcSetSharedGeometryBuffer(geometry, embree::kVertexBuffer, key, format, vertices,
                                     key * (count * size), size, count);
  }
  static void attach_to(embree::Scene scene, embree::Geometry geometry) {
    api.rtcCommitGeometry(geometry);
    api.rtcAttachGeometry(scene, geometry);
    api.rtcReleaseGeometry(geometry);
  }

  void attach_mesh(const PeerMesh& mesh, embree::Scene scene) {
    embree::Geometry geometry = new_geometry(embree::kTriangleGeometry, mesh.keys);
    set_vertices(geometry, embree::kFloat3, mesh.positions, sizeof(Vec3f), mesh.vertices, mesh.keys);
    api.rtcSetSharedGeometryBuffer(geometry, embree::kIndexBuffer, 0, embree::kUint3, mesh.triangles, 0,
                                   3 * sizeof(std::uint32_t), mesh.triangle_count);
    attach_to(scene, geometry);
  }

  void attach_round(const PeerRound& round, embree::Scene scene) {
    const int type = round.kind == PeerRound::Kind::kSpheres ? embree::kSphereGeometry
                     : round.kind == PeerRound::Kind::kTubes ? embree::kRoundBezierGeometry
                                                             : embree::kFlatBezierGeometry;
    embree::Geometry geometry = new_geometry(type, round.keys);
    set_vertices(geometry, embree::kFloat4, round.vertices, sizeof(RoundVertex), round.vertex_count,
                 round.keys);
    if (round.firsts) {
      api.rtcSetSharedGeometryBuffer(geometry, embree::kIndexBuffer, 0, embree::kUint, round.firsts, 0,
                                     sizeof(std::uint32_t), round.span_count);
    }
    attach_to(scene, geometry);
  }

  void attach(const PeerInstance& instance) {
    embree::Geometry geometry = api.rtcNewGeometry(device_, embree::kInstanceGeometry);
    api.rtcSetGeometryInstancedScene(geometry, objects_[instance.object]);
    api.rtcSetGeometryTimeStepCount(geometry, instance.keys);
    static_assert(sizeof(Affine3f) == 12 * sizeof(float));
    for (std::uint32_t key = 0; key < instance.keys; ++key) {
      api.rtcSetGeometryTransform(geometry, key, embree::kFloat3x4ColumnMajor,
                                  &instance.world_from_object[key]);
    }
    api.rtcCommitGeometry(geometry);
    api.rtcAttachGeometry(scene_, geometry);
    api.rtcReleaseGeometry(geometry);
  }

  const PeerScene& input_;
  const bool robust_;
  embree::Device device_ = nullptr;
  embree::Scene scene_ = nullptr;
  std::vector<embree::Scene> objects_;
  std::atomic<std::int64_t> bytes_ = 0;
};

// Its own word for the version; the instruction set follows from the widest packets that it has kernels for.
std::string name_of_library() {
  embree::Device device = api.rtcNewDevice("threads=1");
  if (!device) throw std::runtime_error("bench: Embree made no device");
  const auto property = [&](int which) { return static_cast<int>(api.rtcGetDeviceProperty(device, which)); };
  const int version = property(embree::kVersionProperty);
  const char* set = property(embree::kNativeRay16Property)  ? "AVX-512"
                    : property(embree::kNativeRay8Property) ? "AVX or AVX2"
                                                            : "SSE";
  api.rtcReleaseDevice(device);
  return "Embree " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100) + " (" + set + ")";
}

}  // namespace
}  // namespace msbvh::bench

extern "C" {

std::uint32_t msbvh_peer_abi() { return msbvh::bench::kPeerAbi; }

const char* msbvh_peer_open(const char* folder) {
  static std::string failure;
  failure = msbvh::bench::embree::load_api(folder, msbvh::bench::api);
  return failure.empty() ? nullptr : failure.c_str();
}

const char* msbvh_peer_name() {
  static const std::string name = msbvh::bench::name_of_library();
  return name.c_str();
}

const char* const* msbvh_peer_modes() { return msbvh::bench::kModes; }

msbvh::bench::Peer* msbvh_peer_make(const msbvh::bench::PeerScene& scene, unsigned threads, bool robust) {
  return new msbvh::bench::Embree(scene, threads, robust);
}

}  // extern "C"
