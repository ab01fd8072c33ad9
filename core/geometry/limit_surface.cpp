#include "core/geometry/limit_surface.h"

#include <algorithm>
#include <mutex>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
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
// OpenSubdiv's own default for smooth features. Less saves nothing that matters.
constexpr std::uint32_t kLeastSmoothLevels = 2;

using Cache = Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                               std::unique_lock<std::shared_mutex>>;
using Factory = Bfr::RefinerSurfaceFactory<Cache>;

std::vector<int> ints(const std::vector<std::uint32_t>& v) { return {v.begin(), v.end()}; }

// The pairs of vertices that are edges.
std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const SubdivisionMesh& mesh) {
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

  explicit Creases(const SubdivisionMesh& mesh) {
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

Sdc::SchemeType scheme_of(const SubdivisionMesh& mesh) {
  switch (mesh.scheme) {
    case SubdivisionScheme::kLoop:
      return Sdc::SCHEME_LOOP;
    case SubdivisionScheme::kBilinear:
      return Sdc::SCHEME_BILINEAR;
    default:
      return Sdc::SCHEME_CATMARK;
  }
}

Sdc::Options options_of(const SubdivisionMesh& mesh) {
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(mesh.boundary == BoundaryRule::kNone ? Sdc::Options::VTX_BOUNDARY_NONE
                                      : mesh.boundary == BoundaryRule::kEdgeOnly
                                          ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                          : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  options.SetTriangleSubdivision(mesh.triangle_rule == TriangleRule::kSmooth ? Sdc::Options::TRI_SUB_SMOOTH
                                                                             : Sdc::Options::TRI_SUB_CATMARK);
  return options;
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const SubdivisionMesh& mesh) {
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
  using RefinerFactory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      RefinerFactory::Create(d, RefinerFactory::Options(scheme_of(mesh), options_of(mesh))));
  if (refiner) return refiner;
  throw Error(
      (mesh.name.empty() ? std::string("mesh") : mesh.name) +
      ": faceVertexIndices: found a topology that OpenSubdiv refuses; expected faces of distinct vertices");
}

Factory::Options factory_options(std::uint32_t level) {
  const auto smooth = static_cast<int>(std::max(level, kLeastSmoothLevels));
  Factory::Options options;
  options.SetApproxLevelSmooth(smooth).SetApproxLevelSharp(std::max(smooth, kSharpLevels));
  return options;
}

}  // namespace

struct LimitSurface::Data {
  const SubdivisionMesh& mesh;
  std::unique_ptr<Far::TopologyRefiner> refiner;
  Factory factory;
  std::vector<double> positions;  // of the mesh, as OpenSubdiv takes them

  Data(const SubdivisionMesh& m, std::uint32_t level)
      : mesh(m), refiner(make_refiner(m)), factory(*refiner, factory_options(level)) {
    positions.reserve(3 * mesh.positions.size());
    for (const Vec3f& p : mesh.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  }
  const Far::TopologyLevel& level() const { return refiner->GetLevel(0); }
};

LimitSurface::LimitSurface(const SubdivisionMesh& mesh, std::uint32_t level)
    : data_(std::make_unique<Data>(mesh, level)) {}
LimitSurface::~LimitSurface() = default;

const SubdivisionMesh& LimitSurface::mesh() const { return data_->mesh; }
std::uint32_t LimitSurface::face_count() const {
  return static_cast<std::uint32_t>(data_->level().GetNumFaces());
}
std::uint32_t LimitSurface::edge_count() const {
  return static_cast<std::uint32_t>(data_->level().GetNumEdges());
}
bool LimitSurface::has_limit(std::uint32_t face) const {
  return data_->factory.FaceHasLimitSurface(static_cast<int>(face));
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
bool LimitSurface::is_quad(std::uint32_t face) const {
  return face_vertices(face).size() == 4;  // Loop's faces have 3
}

struct FaceSurface::Data {
  const LimitSurface::Data& limit;
  Bfr::Surface<double> surface;
  Bfr::Parameterization parameters;
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

FaceSurface::FaceSurface(const LimitSurface& surface, std::uint32_t face)
    : data_(std::make_unique<Data>(Data{*surface.data_, {}, {}, {}})) {
  if (!surface.data_->factory.InitVertexSurface(static_cast<int>(face), &data_->surface))
    throw Error("limit surface: face " + std::to_string(face) + " has none");
  data_->parameters = data_->surface.GetParameterization();
  data_->points.resize(3 * static_cast<std::size_t>(data_->surface.GetNumPatchPoints()));
  set_control(0);
}
FaceSurface::~FaceSurface() = default;

void FaceSurface::set_control(std::uint32_t control) {
  const double* first =
      data_->limit.positions.data() + 3 * std::size_t(control) * data_->limit.mesh.vertex_count;
  data_->surface.PreparePatchPoints(first, 3, data_->points.data(), 3);
}

LimitPoint FaceSurface::evaluate(std::uint32_t square, double s, double t) const {
  const Vec3d p = data_->parameters_at(square, s, t);
  const double uv[2] = {p.x, p.y};
  LimitPoint out;
  data_->surface.Evaluate(uv, data_->points.data(), 3, &out.position.x, &out.du.x, &out.dv.x);
  return out;
}

}  // namespace msbvh
