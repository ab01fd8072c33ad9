#include "core/geometry/subdivision/limit_surface.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <optional>
#include <set>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/lerp.h"

namespace msbvh {
namespace {

using namespace OpenSubdiv;

// Sharpness from which OpenSubdiv takes an edge as infinitely sharp is 10: that many levels for the others.
constexpr int kSharpLevels = 10;
// A crease that runs down more levels below the finest points than these rounds off within a sixteenth of
// their distance. Following it further moves points by a hundredth of it (docs/design/subdivision.md), and
// each level doubles what it takes.
constexpr int kSharpLevelsBelow = 4;
// OpenSubdiv's own default for smooth features. Less saves nothing that matters.
constexpr std::uint32_t kLeastSmoothLevels = 2;

using ThreadedCache = Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                                       std::unique_lock<std::shared_mutex>>;

// What OpenSubdiv has prepared of faces around extraordinary vertices and sharp edges, for those alike. Where
// every edge has a sharpness of its own no two are, and one of sharpness 9 takes 5 MB: from kMostBytes on
// they are prepared again whenever they are asked for.
class Cache final : public ThreadedCache {
 public:
  static constexpr std::size_t kMostBytes = std::size_t(64) << 20;

  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  // Around the making of a surface, by one thread.
  static void begin() { added_ = false; }
  void end(std::size_t bytes) {
    if (added_) bytes_.fetch_add(bytes, std::memory_order_relaxed);
  }

 private:
  DataType Add(const KeyType& key, const DataType& data) override {
    if (bytes() >= kMostBytes) return data;
    added_ = true;
    return ThreadedCache::Add(key, data);
  }

  std::atomic<std::size_t> bytes_ = 0;
  static inline thread_local bool added_ = false;
};
using Factory = Bfr::RefinerSurfaceFactory<Cache>;

std::vector<int> ints(const std::vector<std::uint32_t>& v) { return {v.begin(), v.end()}; }

// The pairs of vertices that are edges.
std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const Cage& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> out;
  std::size_t at = 0;
  for (const std::uint32_t n : mesh.face_vertex_counts) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = mesh.face_vertex_indices[at + i],
                          b = mesh.face_vertex_indices[at + (i + 1) % n];
      out.emplace(std::min(a, b), std::max(a, b));
    }
    at += n;
  }
  return out;
}

// USD's chains of crease vertices as OpenSubdiv's edges. Pairs that are no edge are left out, as OpenSubdiv
// would, which prints a line for each.
struct Creases {
  std::vector<int> pairs;
  std::vector<float> weights;

  explicit Creases(const Cage& mesh) {
    if (mesh.crease_lengths.empty()) return;
    const auto edges = edges_of(mesh);
    const bool by_chain = mesh.crease_sharpnesses.size() == mesh.crease_lengths.size();
    std::size_t at = 0, edge = 0;
    for (std::size_t c = 0; c < mesh.crease_lengths.size(); at += mesh.crease_lengths[c++]) {
      for (std::uint32_t i = 0; i + 1 < mesh.crease_lengths[c]; ++i, ++edge) {
        const std::uint32_t a = mesh.crease_indices[at + i], b = mesh.crease_indices[at + i + 1];
        if (!edges.contains({std::min(a, b), std::max(a, b)})) continue;
        pairs.push_back(static_cast<int>(a));
        pairs.push_back(static_cast<int>(b));
        weights.push_back(mesh.crease_sharpnesses[by_chain ? c : edge]);
      }
    }
  }
};

Sdc::SchemeType scheme_of(const Cage& mesh) {
  switch (mesh.scheme) {
    case SubdivisionScheme::kLoop:
      return Sdc::SCHEME_LOOP;
    case SubdivisionScheme::kBilinear:
      return Sdc::SCHEME_BILINEAR;
    default:
      return Sdc::SCHEME_CATMARK;
  }
}

Sdc::Options::FVarLinearInterpolation linear_of(FaceVaryingRule rule) {
  switch (rule) {
    case FaceVaryingRule::kNone:
      return Sdc::Options::FVAR_LINEAR_NONE;
    case FaceVaryingRule::kCornersOnly:
      return Sdc::Options::FVAR_LINEAR_CORNERS_ONLY;
    case FaceVaryingRule::kCornersPlus2:
      return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2;
    case FaceVaryingRule::kBoundaries:
      return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
    case FaceVaryingRule::kAll:
      return Sdc::Options::FVAR_LINEAR_ALL;
    default:
      return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1;
  }
}

Sdc::Options options_of(const Cage& mesh) {
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(mesh.boundary == BoundaryRule::kNone ? Sdc::Options::VTX_BOUNDARY_NONE
                                      : mesh.boundary == BoundaryRule::kEdgeOnly
                                          ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                          : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  options.SetFVarLinearInterpolation(linear_of(mesh.face_varying_rule));
  options.SetTriangleSubdivision(mesh.triangle_rule == TriangleRule::kSmooth ? Sdc::Options::TRI_SUB_SMOOTH
                                                                             : Sdc::Options::TRI_SUB_CATMARK);
  return options;
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Cage& mesh) {
  const std::vector<int> counts = ints(mesh.face_vertex_counts), indices = ints(mesh.face_vertex_indices);
  const std::vector<int> corners = ints(mesh.corner_indices), holes = ints(mesh.holes);
  const Creases creases(mesh);
  Far::TopologyDescriptor d;
  d.numVertices = static_cast<int>(mesh.vertex_count);
  d.numFaces = static_cast<int>(counts.size());
  d.numVertsPerFace = counts.data();
  d.vertIndicesPerFace = indices.data();
  d.numCreases = static_cast<int>(creases.weights.size());
  d.creaseVertexIndexPairs = creases.pairs.data();
  d.creaseWeights = creases.weights.data();
  d.numCorners = static_cast<int>(corners.size());
  d.cornerVertexIndices = corners.data();
  d.cornerWeights = mesh.corner_sharpnesses.data();
  d.numHoles = static_cast<int>(holes.size());
  d.holeIndices = holes.data();
  d.isLeftHanded = mesh.left_handed;
  std::vector<std::vector<int>> indices_of(mesh.face_varying.size());
  std::vector<Far::TopologyDescriptor::FVarChannel> channels(mesh.face_varying.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    indices_of[c] = ints(mesh.face_varying[c].indices);
    channels[c].numValues = static_cast<int>(mesh.face_varying[c].value_count);
    channels[c].valueIndices = indices_of[c].data();
  }
  d.numFVarChannels = static_cast<int>(channels.size());
  d.fvarChannels = channels.data();
  using RefinerFactory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      RefinerFactory::Create(d, RefinerFactory::Options(scheme_of(mesh), options_of(mesh))));
  if (refiner) return refiner;
  throw Error(
      (mesh.name.empty() ? std::string("mesh") : mesh.name) +
      ": faceVertexIndices: found a topology that OpenSubdiv refuses; expected faces of distinct vertices");
}

Factory::Options factory_options(std::uint32_t level, Cache& cache) {
  const auto smooth = static_cast<int>(std::max(level, kLeastSmoothLevels));
  Factory::Options options;
  options.SetApproxLevelSmooth(smooth).SetApproxLevelSharp(
      std::min(smooth + kSharpLevelsBelow, kSharpLevels));
  options.SetExternalCache(&cache);
  return options;
}

}  // namespace

struct LimitSurface::Data {
  const Cage& cage;
  std::shared_ptr<const Far::TopologyRefiner> refiner;
  std::unique_ptr<Cache> cache{};  // outlives the factory
  std::optional<Factory> factory{};

  Data(const Cage& c, std::shared_ptr<const Far::TopologyRefiner> r) : cage(c), refiner(std::move(r)) {}
  const Far::TopologyLevel& level() const { return refiner->GetLevel(0); }
};

LimitSurface::LimitSurface(const Cage& cage) : data_(std::make_unique<Data>(cage, make_refiner(cage))) {}
LimitSurface::LimitSurface(const LimitSurface& same, std::uint32_t level)
    : data_(std::make_unique<Data>(same.data_->cage, same.data_->refiner)) {
  prepare(level);
}
LimitSurface::~LimitSurface() = default;

void LimitSurface::prepare(std::uint32_t level) {
  auto cache = std::make_unique<Cache>();
  data_->factory.emplace(*data_->refiner, factory_options(level, *cache));
  data_->cache = std::move(cache);
}

std::size_t LimitSurface::irregular_bytes() const { return data_->cache ? data_->cache->bytes() : 0; }

const Cage& LimitSurface::cage() const { return data_->cage; }
std::uint32_t LimitSurface::face_count() const {
  return static_cast<std::uint32_t>(data_->level().GetNumFaces());
}
std::uint32_t LimitSurface::edge_count() const {
  return static_cast<std::uint32_t>(data_->level().GetNumEdges());
}
bool LimitSurface::has_limit(std::uint32_t face) const {
  return data_->factory->FaceHasLimitSurface(static_cast<int>(face));
}
bool LimitSurface::has_creases() const {
  if (data_->cage.scheme == SubdivisionScheme::kBilinear) return true;
  const Far::TopologyLevel& level = data_->level();
  for (int e = 0; e < level.GetNumEdges(); ++e) {
    if (level.IsEdgeNonManifold(e)) return true;
    if (!level.IsEdgeBoundary(e) && Sdc::Crease::IsInfinite(level.GetEdgeSharpness(e))) return true;
  }
  for (int v = 0; v < level.GetNumVertices(); ++v) {
    if (level.IsVertexNonManifold(v)) return true;
    if (!level.IsVertexBoundary(v) && Sdc::Crease::IsInfinite(level.GetVertexSharpness(v))) return true;
  }
  return false;
}
std::span<const int> LimitSurface::face_vertices(std::uint32_t face) const {
  const Far::ConstIndexArray v = data_->level().GetFaceVertices(static_cast<int>(face));
  return {v.begin(), static_cast<std::size_t>(v.size())};
}
std::span<const int> LimitSurface::face_edges(std::uint32_t face) const {
  const Far::ConstIndexArray e = data_->level().GetFaceEdges(static_cast<int>(face));
  return {e.begin(), static_cast<std::size_t>(e.size())};
}
std::uint32_t LimitSurface::edge_start(std::uint32_t edge) const {
  return static_cast<std::uint32_t>(data_->level().GetEdgeVertices(static_cast<int>(edge))[0]);
}
bool LimitSurface::is_sharp(std::uint32_t edge) const {
  const Far::TopologyLevel& level = data_->level();
  const auto e = static_cast<int>(edge);
  if (level.IsEdgeBoundary(e) || level.IsEdgeNonManifold(e) || level.GetEdgeSharpness(e) > 0.0f) return true;
  for (const int face : level.GetEdgeFaces(e)) {
    if (!has_limit(static_cast<std::uint32_t>(face))) return true;
  }
  return false;
}
bool LimitSurface::is_quad(std::uint32_t face) const {
  return face_vertices(face).size() == 4;  // Loop's faces have 3
}

struct FaceSurface::Data {
  Bfr::Surface<double> surface;
  Bfr::Parameterization parameters;
  std::uint32_t width = 0;
  std::vector<int> indices;  // of the cage's values that the face takes
  std::vector<double> points;

  Vec3d corner(int i) const {
    double uv[2];
    parameters.GetVertexCoord(i, uv);
    return {uv[0], uv[1], 0.0};
  }
  // (u, v) of a place in a square: of a triangle the bilinear one between a vertex, two middles of edges and
  // the centre, which is affine along the triangle's edges.
  Vec3d parameters_at(std::uint32_t square, double s, double t) const {
    const int i = static_cast<int>(square);
    if (parameters.GetType() == Bfr::Parameterization::QUAD) return {s, t, 0.0};
    if (parameters.HasSubFaces()) {
      const double st[2] = {s, t};
      double uv[2];
      parameters.ConvertNormalizedSubFaceToCoord(i, st, uv);
      return {uv[0], uv[1], 0.0};
    }
    const Vec3d v = corner(i), next = corner((i + 1) % 3), last = corner((i + 2) % 3);
    const Vec3d out = (v + next) * 0.5, in = (v + last) * 0.5, centre = (v + next + last) * (1.0 / 3.0);
    return lerp(lerp(v, out, s), lerp(in, centre, s), t);
  }
};

FaceSurface::FaceSurface(const LimitSurface& surface, std::uint32_t face, ValueKind kind)
    : data_(std::make_unique<Data>()) {
  const Factory& factory = *surface.data_->factory;
  const auto index = static_cast<int>(face);
  const auto made = [&](auto* out) {
    switch (kind.kind) {
      case ValueKind::kVarying:
        return factory.InitVaryingSurface(index, out);
      case ValueKind::kFaceVarying:
        return factory.InitFaceVaryingSurface(index, out, Bfr::SurfaceFactory::FVarID(kind.channel));
      default:
        return factory.InitVertexSurface(index, out);
    }
  };
  Cache::begin();
  if (!made(&data_->surface)) throw Error("limit surface: face " + std::to_string(face) + " has none");
  const auto controls = static_cast<std::size_t>(data_->surface.GetNumControlPoints());
  const auto points = static_cast<std::size_t>(data_->surface.GetNumPatchPoints());
  // Half of what a patch takes are its weights; measured.
  surface.data_->cache->end(2 * points * controls * sizeof(double));
  data_->parameters = data_->surface.GetParameterization();
  data_->indices.resize(controls);
  data_->surface.GetControlPointIndices(data_->indices.data());
}
FaceSurface::~FaceSurface() = default;

void FaceSurface::set_values(const float* values, std::uint32_t width) {
  Data& d = *data_;
  d.width = width;
  d.points.resize(std::size_t(width) * static_cast<std::size_t>(d.surface.GetNumPatchPoints()));
  double* to = d.points.data();
  for (const int index : d.indices) to = std::copy_n(values + std::size_t(index) * width, width, to);
  d.surface.ComputePatchPoints(d.points.data(), Bfr::Surface<double>::PointDescriptor(int(width)));
}

void FaceSurface::evaluate(std::uint32_t square, double s, double t, double* out) const {
  const Data& d = *data_;
  const Vec3d p = d.parameters_at(square, s, t);
  const double uv[2] = {p.x, p.y};
  d.surface.Evaluate(uv, d.points.data(), Bfr::Surface<double>::PointDescriptor(int(d.width)), out);
}

LimitPoint FaceSurface::evaluate(std::uint32_t square, double s, double t) const {
  const Vec3d p = data_->parameters_at(square, s, t);
  const double uv[2] = {p.x, p.y};
  LimitPoint out;
  data_->surface.Evaluate(uv, data_->points.data(), 3, &out.position.x, &out.du.x, &out.dv.x);
  return out;
}

}  // namespace msbvh
