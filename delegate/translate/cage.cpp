#include "delegate/translate/cage.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <utility>

namespace msbvh::translate {
namespace {

template <typename T>
using Names = std::initializer_list<std::pair<const char*, T>>;

template <typename T>
const T* find(const Names<T>& names, const std::string& token) {
  for (const auto& [name, value] : names) {
    if (token == name) return &value;
  }
  return nullptr;
}

template <typename T>
std::string listed(const Names<T>& names) {
  std::string text;
  for (const auto& [name, value] : names) {
    if (!text.empty()) text += &name == &std::prev(names.end())->first ? " or " : ", ";
    text += name;
  }
  return text;
}

constexpr Names<SubdivisionScheme> kSchemes = {{"catmullClark", SubdivisionScheme::kCatmullClark},
                                               {"loop", SubdivisionScheme::kLoop},
                                               {"bilinear", SubdivisionScheme::kBilinear}};
constexpr Names<BoundaryRule> kBoundaryRules = {{"edgeAndCorner", BoundaryRule::kEdgeAndCorner},
                                                {"edgeOnly", BoundaryRule::kEdgeOnly},
                                                {"none", BoundaryRule::kNone}};
constexpr Names<TriangleRule> kTriangleRules = {{"catmullClark", TriangleRule::kCatmullClark},
                                                {"smooth", TriangleRule::kSmooth}};
constexpr Names<FaceVaryingRule> kFaceVaryingRules = {
    {"cornersPlus1", FaceVaryingRule::kCornersPlus1}, {"none", FaceVaryingRule::kNone},
    {"cornersOnly", FaceVaryingRule::kCornersOnly},   {"cornersPlus2", FaceVaryingRule::kCornersPlus2},
    {"boundaries", FaceVaryingRule::kBoundaries},     {"all", FaceVaryingRule::kAll}};

// The first of the names, USD's default, with a warning, where the token is none of them.
template <typename T>
T rule_of(const Names<T>& names, const std::string& token, const char* attribute, PrimLog& log) {
  if (const T* found = find(names, token)) return *found;
  log.warn(attribute,
           message("found \"", token, "\"; expected ", listed(names), "; took ", names.begin()->first));
  return names.begin()->second;
}

std::vector<std::uint32_t> unsigned_of(std::span<const int> values) { return {values.begin(), values.end()}; }

bool check_range(std::span<const int> indices, std::size_t limit, const char* attribute, PrimLog& log) {
  const auto bad =
      std::ranges::find_if(indices, [&](int index) { return index < 0 || std::size_t(index) >= limit; });
  if (bad == indices.end()) return true;
  return log.reject(attribute, message("index ", bad - indices.begin(), " is ", *bad, "; expected 0 to ",
                                       std::ptrdiff_t(limit) - 1));
}

bool check_sharpnesses(std::span<const float> values, const char* attribute, PrimLog& log) {
  const auto bad = std::ranges::find_if(values, [](float value) { return !(value >= 0.0f); });
  if (bad == values.end()) return true;
  return log.reject(attribute, message("value ", bad - values.begin(), " is ", *bad,
                                       "; expected 0 (smooth) to 10 (sharp)"));
}

bool check_creases(const SubdivisionInput& input, std::size_t point_count, PrimLog& log) {
  std::int64_t vertices = 0;
  for (std::size_t i = 0; i < input.crease_lengths.size(); ++i) {
    if (input.crease_lengths[i] < 2)
      return log.reject("creaseLengths", message("crease ", i, " has ", input.crease_lengths[i],
                                                 " vertices; expected 2 or more"));
    vertices += input.crease_lengths[i];
  }
  if (vertices != std::int64_t(input.crease_indices.size()))
    return log.reject("creaseLengths", message("the lengths add up to ", vertices, "; expected ",
                                               input.crease_indices.size(), ", the number of creaseIndices"));
  const std::size_t creases = input.crease_lengths.size(), edges = input.crease_indices.size() - creases;
  const std::size_t found = input.crease_sharpnesses.size();
  if (found != creases && found != edges)
    return log.reject("creaseSharpnesses", message("found ", found, " values; expected ", creases,
                                                   " (one a crease) or ", edges, " (one an edge)"));
  return check_range(input.crease_indices, point_count, "creaseIndices", log) &&
         check_sharpnesses(input.crease_sharpnesses, "creaseSharpnesses", log);
}

bool check_corners(const SubdivisionInput& input, std::size_t point_count, PrimLog& log) {
  if (input.corner_sharpnesses.size() != input.corner_indices.size())
    return log.reject("cornerSharpnesses",
                      message("found ", input.corner_sharpnesses.size(), " values; expected ",
                              input.corner_indices.size(), ", the number of cornerIndices"));
  return check_range(input.corner_indices, point_count, "cornerIndices", log) &&
         check_sharpnesses(input.corner_sharpnesses, "cornerSharpnesses", log);
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<Edge> edges_of(const Cage& cage) {
  std::vector<Edge> edges;
  edges.reserve(cage.face_vertex_indices.size());
  const std::uint32_t* corner = cage.face_vertex_indices.data();
  for (const std::uint32_t count : cage.face_vertex_counts) {
    for (std::uint32_t i = 0; i < count; ++i)
      edges.push_back(edge_of(corner[i], corner[i + 1 == count ? 0 : i + 1]));
    corner += count;
  }
  std::ranges::sort(edges);
  return edges;
}

// Creases that lead along no edge shape nothing.
void report_lost_creases(const Cage& cage, PrimLog& log) {
  const std::vector<Edge> edges = edges_of(cage);
  std::size_t at = 0, pairs = 0, lost = 0;
  Edge first{};
  for (const std::uint32_t length : cage.crease_lengths) {
    for (std::uint32_t i = 0; i + 1 < length; ++i, ++pairs) {
      const Edge pair{cage.crease_indices[at + i], cage.crease_indices[at + i + 1]};
      if (std::ranges::binary_search(edges, edge_of(pair.first, pair.second))) continue;
      if (lost++ == 0) first = pair;
    }
    at += length;
  }
  if (lost > 0)
    log.warn("creaseIndices", message(lost, " of ", pairs, " pairs of vertices are left out (the first is ",
                                      first.first, ", ", first.second, "); expected edges of the mesh"));
}

void add_features(const SubdivisionInput& input, std::size_t point_count, Cage& cage, PrimLog& log) {
  PrimLog optional = log.of_optional_part();
  const bool creased = !(input.crease_lengths.empty() && input.crease_indices.empty());
  if (creased && check_creases(input, point_count, optional)) {
    cage.crease_lengths = unsigned_of(input.crease_lengths);
    cage.crease_indices = unsigned_of(input.crease_indices);
    cage.crease_sharpnesses.assign(input.crease_sharpnesses.begin(), input.crease_sharpnesses.end());
    report_lost_creases(cage, log);
  }
  if (!input.corner_indices.empty() && check_corners(input, point_count, optional)) {
    cage.corner_indices = unsigned_of(input.corner_indices);
    cage.corner_sharpnesses.assign(input.corner_sharpnesses.begin(), input.corner_sharpnesses.end());
  }
}

void add_faces(const MeshInput& input, InputCage& result) {
  const auto counts = input.face_vertex_counts;
  const bool whole = std::ranges::all_of(counts, [](int count) { return count >= 3; });
  std::vector<bool> holes(counts.size(), false);
  for (const int face : input.hole_indices) {
    if (face >= 0 && std::size_t(face) < holes.size()) holes[std::size_t(face)] = true;
  }
  Cage& cage = result.cage;
  std::uint32_t corner = 0;
  for (std::uint32_t face = 0; face < counts.size(); corner += std::uint32_t(counts[face++])) {
    if (counts[face] < 3) continue;
    if (holes[face]) cage.holes.push_back(std::uint32_t(cage.face_vertex_counts.size()));
    cage.face_vertex_counts.push_back(std::uint32_t(counts[face]));
    for (int i = 0; i < counts[face]; ++i) {
      cage.face_vertex_indices.push_back(std::uint32_t(input.face_vertex_indices[corner + std::uint32_t(i)]));
      if (!whole) result.corners.push_back(corner + std::uint32_t(i));
    }
    if (!whole) result.faces.push_back(face);
  }
}

// What does not fit is said where the primvar itself is read.
template <typename T>
void add_channel(const PrimvarInput<T>& primvar, const char* attribute, std::size_t corner_count,
                 InputCage& result) {
  if (primvar.interpolation != "faceVarying" || primvar.values.empty()) return;
  const std::size_t values = primvar.values.size();
  const bool indexed = !primvar.indices.empty();
  if ((indexed ? primvar.indices.size() : values) != corner_count) return;
  const auto outside = [&](int index) { return index < 0 || std::size_t(index) >= values; };
  if (std::ranges::any_of(primvar.indices, outside)) return;
  FaceVaryingTopology topology;
  topology.value_count = std::uint32_t(values);
  for (std::uint32_t i = 0; i < result.cage.face_vertex_indices.size(); ++i) {
    const std::uint32_t corner = result.corners.empty() ? i : result.corners[i];
    topology.indices.push_back(indexed ? std::uint32_t(primvar.indices[corner]) : corner);
  }
  result.channels.emplace(attribute, std::uint32_t(result.cage.face_varying.size()));
  result.cage.face_varying.push_back(std::move(topology));
}

}  // namespace

std::optional<InputCage> cage_of(const MeshInput& input, std::size_t point_count, PrimLog& log) {
  const SubdivisionInput& given = input.subdivision;
  if (given.scheme == "none") return std::nullopt;
  const SubdivisionScheme* scheme = find(kSchemes, given.scheme);
  if (!scheme) {
    log.warn("subdivisionScheme", message("found \"", given.scheme, "\"; expected ", listed(kSchemes),
                                          ", or none; the cage is drawn as polygons"));
    return std::nullopt;
  }
  const auto large = std::ranges::find_if(input.face_vertex_counts, [](int count) { return count > 3; });
  if (*scheme == SubdivisionScheme::kLoop && large != input.face_vertex_counts.end()) {
    log.warn("faceVertexCounts",
             message("face ", large - input.face_vertex_counts.begin(), " has ", *large,
                     " vertices; expected 3, for the scheme loop; the cage is drawn as polygons"));
    return std::nullopt;
  }
  InputCage result;
  Cage& cage = result.cage;
  cage.name = input.path;
  cage.vertex_count = std::uint32_t(point_count);
  cage.scheme = *scheme;
  cage.boundary = rule_of(kBoundaryRules, given.interpolate_boundary, "interpolateBoundary", log);
  cage.triangle_rule = rule_of(kTriangleRules, given.triangle_rule, "triangleSubdivisionRule", log);
  cage.face_varying_rule =
      rule_of(kFaceVaryingRules, given.face_varying_linear, "faceVaryingLinearInterpolation", log);
  cage.left_handed = input.left_handed;
  add_faces(input, result);
  add_features(given, point_count, cage, log);
  const std::size_t corners = input.face_vertex_indices.size();
  add_channel(input.display_color, "primvars:displayColor", corners, result);
  add_channel(input.display_opacity, "primvars:displayOpacity", corners, result);
  for (const NamedPrimvar& named : input.named_primvars)
    add_channel(named.primvar, full_name(named).c_str(), corners, result);
  return result;
}

}  // namespace msbvh::translate
