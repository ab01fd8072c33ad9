#include "bench/peer_input.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/grid_triangles.h"
#include "core/motion/affine_track.h"

namespace msbvh::bench {
namespace {

// Where a sampled track is compared with ours: thrice within each of the peer's segments.
constexpr double kBetween[] = {0.25, 0.5, 0.75};

// Fewest segments whose straight lines stay within the tolerance; `error(segments)` is their deviation.
template <typename Error>
std::uint32_t fewest_segments(double tolerance, double& found, const Error& error) {
  for (std::uint32_t segments = 1;; segments *= 2) {
    found = error(segments);
    if (found <= tolerance || segments == kMaxSegments) return segments;
  }
}

class Filler {
 public:
  Filler(const Scene& scene, double tolerance, PeerInput& out)
      : in_(scene), tolerance_(tolerance), out_(out) {}

  void run() {
    for (const GeometryId i : in_.world) add(i, {}, out_.scene.world);
    for (const Prototype& prototype : in_.prototypes) {
      expect_visible(prototype.time_remap, prototype.name);
      PeerObject& object = out_.scene.objects.emplace_back();
      for (const GeometryId i : prototype.geometry) add(i, prototype.time_remap, object);
    }
    for (const InstanceSet& set : in_.instances) {
      expect_visible(set.time_remap, set.name);
      const std::uint32_t controls = set.form().controls();
      for (std::size_t i = 0; i < instance_count(set); ++i)
        instance(set, {&set.world_from_prototype[i * controls], controls});
    }
  }

 private:
  void expect_visible(const TimeRemap& time_remap, const std::string& name) {
    const auto hidden = [](const TimeRemapPiece& piece) { return !piece.visible; };
    if (std::ranges::any_of(time_remap.pieces, hidden))
      out_.missing = name + ": visible for a part of the shutter";
  }

  void add(GeometryId id, const TimeRemap& time_remap, PeerObject& object) {
    switch (id.kind()) {
      case GeometryKind::kTriangleMesh:
        object.meshes.push_back(mesh(in_.mesh(id).shape, time_remap));
        return;
      case GeometryKind::kCurves: {
        const CurveSet& set = in_.curves[id.index()].shape;
        if (set.shape == CurveShape::kOriented) out_.missing = set.name + ": ribbons across normals";
        const auto kind =
            set.shape == CurveShape::kTube ? PeerRound::Kind::kTubes : PeerRound::Kind::kRibbons;
        object.round.push_back({kind, set.vertices.data(), key_count(set.segments), set.vertex_count,
                                set.spans.data(), set.span_count()});
        expect_linear(set, time_remap);
        return;
      }
      case GeometryKind::kPoints: {
        const PointSet& set = in_.points[id.index()].shape;
        object.round.push_back({PeerRound::Kind::kSpheres, set.vertices.data(), key_count(set.segments),
                                set.point_count, nullptr, 0});
        expect_linear(set, time_remap);
        return;
      }
      case GeometryKind::kGridMesh:
        out_.meshes.push_back(triangles_of(in_.grids[id.index()].shape));
        object.meshes.push_back(mesh(out_.meshes.back(), time_remap));
        return;
    }
  }
  template <typename Set>
  void expect_linear(const Set& set, const TimeRemap& time_remap) {
    if (set.segments != 0 && (set.degree > 1 || !time_remap.is_shutter()))
      out_.missing = set.name + ": curves and points on tracks that are not linear at even times";
    out_.keys = std::max(out_.keys, key_count(set.segments));
  }

  PeerMesh mesh(const TriangleMesh& shape, const TimeRemap& time_remap) {
    PeerMesh peer{shape.positions.data(), key_count(shape.segments), shape.vertex_count,
                  shape.triangles.empty() ? nullptr : shape.triangles[0].data(),
                  static_cast<std::uint32_t>(shape.triangles.size())};
    if (shape.segments != 0 && (shape.degree > 1 || !time_remap.is_shutter()))
      sample(shape, time_remap, peer);
    out_.keys = std::max(out_.keys, peer.keys);
    return peer;
  }

  static float local(const TimeRemap& time_remap, double u) {
    float time = static_cast<float>(u);
    time_remap.at(time, time);
    return time;
  }

  void sample(const TriangleMesh& shape, const TimeRemap& time_remap, PeerMesh& peer) {
    const auto at = [&](std::uint32_t v, double u) { return Vec3d(shape.position(v, local(time_remap, u))); };
    double error = 0.0;
    const std::uint32_t step = 1 + shape.vertex_count / 4096;  // a sample of the vertices decides
    const std::uint32_t segments = fewest_segments(tolerance_, error, [&](std::uint32_t n) {
      double worst = 0.0;
      for (std::uint32_t v = 0; v < shape.vertex_count; v += step) {
        for (std::uint32_t k = 0; k < n; ++k) {
          const Vec3d a = at(v, double(k) / n), b = at(v, (k + 1.0) / n);
          for (const double w : kBetween)
            worst = std::max(worst, length(at(v, (k + w) / n) - (a + (b - a) * w)));
        }
      }
      return worst;
    });
    std::vector<Vec3f>& positions = out_.positions.emplace_back();
    for (std::uint32_t k = 0; k <= segments; ++k) {
      for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
        positions.push_back(Vec3f(at(v, double(k) / segments)));
    }
    positions.resize(positions.size() + TriangleMesh::kGuard);
    peer.positions = positions.data();
    peer.keys = key_count(segments);
    note(error);
  }

  void instance(const InstanceSet& set, std::span<const Affine3f> controls) {
    PeerInstance peer{set.prototype, key_count(set.segments), controls.data()};
    if (set.segments != 0 && (set.degree > 1 || !set.time_remap.is_shutter())) sample(set, controls, peer);
    out_.keys = std::max(out_.keys, peer.keys);
    out_.scene.instances.push_back(peer);
  }

  // Deviations are those of the columns, as if the object reached one unit from its origin.
  void sample(const InstanceSet& set, std::span<const Affine3f> controls, PeerInstance& peer) {
    const auto at = [&](double u) {
      return Affine3d(evaluate(controls, set.form(), local(set.time_remap, u)));
    };
    double error = 0.0;
    const std::uint32_t segments = fewest_segments(tolerance_, error, [&](std::uint32_t n) {
      double worst = 0.0;
      for (std::uint32_t k = 0; k < n; ++k) {
        const Affine3d a = at(double(k) / n), b = at((k + 1.0) / n);
        for (const double w : kBetween) {
          const Affine3d m = at((k + w) / n);
          for (const auto column : {&Affine3d::x, &Affine3d::y, &Affine3d::z, &Affine3d::t}) {
            worst = std::max(worst, length(m.*column - (a.*column + (b.*column - a.*column) * w)));
          }
        }
      }
      return worst;
    });
    std::vector<Affine3f>& maps = out_.maps.emplace_back();
    for (std::uint32_t k = 0; k <= segments; ++k) maps.push_back(Affine3f(at(double(k) / segments)));
    peer.world_from_object = maps.data();
    peer.keys = key_count(segments);
    note(error);
  }

  void note(double error) {
    out_.sampled = true;
    out_.error = std::max(out_.error, error);
  }

  const Scene& in_;
  const double tolerance_;
  PeerInput& out_;
};

}  // namespace

void fill_peer_input(const Scene& scene, double tolerance, PeerInput& out) {
  Filler(scene, tolerance, out).run();
}

}  // namespace msbvh::bench
