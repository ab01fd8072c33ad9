#include "delegate/translate/primvars.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "delegate/translate/primvar_track.h"

namespace msbvh::translate {
namespace {

std::optional<Interpolation> interpolation_from(const std::string& token) {
  if (token == "constant") return Interpolation::kConstant;
  if (token == "uniform") return Interpolation::kTriangle;
  if (token == "vertex" || token == "varying") return Interpolation::kVertex;
  if (token == "faceVarying") return Interpolation::kFaceVarying;
  return std::nullopt;
}

// Values that USD expects, before triangulation.
std::size_t expected_count(Interpolation interpolation, const Triangulation& mesh) {
  switch (interpolation) {
    case Interpolation::kConstant:
      return 1;
    case Interpolation::kTriangle:
      return mesh.face_count;
    case Interpolation::kVertex:
      return mesh.point_count;
    case Interpolation::kFaceVarying:
      return mesh.face_vertex_count;
  }
  return 0;
}

// Elements of the triangle mesh as elements of the polygons.
std::vector<std::uint32_t> polygon_elements(Interpolation interpolation, const Triangulation& mesh) {
  if (interpolation == Interpolation::kTriangle) return mesh.faces;
  std::vector<std::uint32_t> elements;
  if (interpolation == Interpolation::kFaceVarying) {
    elements.reserve(3 * mesh.corners.size());
    for (const Triangle& corners : mesh.corners)
      elements.insert(elements.end(), corners.begin(), corners.end());
  } else {
    elements.resize(expected_count(interpolation, mesh));
    std::iota(elements.begin(), elements.end(), 0u);
  }
  return elements;
}

bool check_indices(std::span<const int> indices, std::size_t value_count, const std::string& attribute,
                   PrimLog& log) {
  const auto bad = std::ranges::find_if(
      indices, [&](int index) { return index < 0 || std::size_t(index) >= value_count; });
  if (bad == indices.end()) return true;
  return log.reject(attribute, message("index ", bad - indices.begin(), " is ", *bad, "; expected less than ",
                                       value_count, ", the number of values"));
}

}  // namespace

std::optional<PrimvarMap> map_primvar(const std::string& token, std::size_t value_count,
                                      std::span<const int> indices, const Triangulation& mesh,
                                      const std::string& attribute, PrimLog& log) {
  const std::optional<Interpolation> interpolation = interpolation_from(token);
  if (!interpolation) {
    log.reject(attribute, message("found the interpolation \"", token,
                                  "\"; expected constant, uniform, varying, ", "vertex or faceVarying"));
    return std::nullopt;
  }
  const std::size_t expected = expected_count(*interpolation, mesh);
  const std::size_t found = indices.empty() ? value_count : indices.size();
  if (found != expected) {
    log.reject(attribute, message("found ", found, indices.empty() ? " values" : " indices", "; expected ",
                                  expected, " for the interpolation ", token, ""));
    return std::nullopt;
  }
  if (!check_indices(indices, value_count, attribute, log)) return std::nullopt;
  PrimvarMap map{*interpolation, polygon_elements(*interpolation, mesh)};
  if (!indices.empty()) {
    for (std::uint32_t& element : map.source) element = std::uint32_t(indices[element]);
  }
  return map;
}

namespace {

// One of the authored values for each element, at every key.
template <typename T>
Primvar<T> gathered(Interpolation interpolation, const std::vector<std::uint32_t>& source,
                    const PrimvarTrack<T>& track, std::size_t value_count) {
  Primvar<T> result{interpolation, track.segments, {}};
  result.values.reserve(source.size() * key_count(track.segments));
  for (std::uint32_t key = 0; key < key_count(track.segments); ++key) {
    const T* values = track.values.data() + key * value_count;
    for (const std::uint32_t element : source) result.values.push_back(values[element]);
  }
  return result;
}

// Of the value of each face.
std::vector<std::uint32_t> of_faces(const std::vector<std::uint32_t>& faces, std::span<const int> indices) {
  std::vector<std::uint32_t> source = faces;
  if (!indices.empty()) {
    for (std::uint32_t& face : source) face = std::uint32_t(indices[face]);
  }
  return source;
}

// On the limit surface. `authored`: gathered on the cage's polygons, one a vertex (vertex, varying), or the
// channel's own values (faceVarying).
template <typename T>
Primvar<T> refined(ValueKind kind, std::size_t value_count, const Primvar<T>& authored,
                   const Tessellation& tessellation) {
  const RefinedMesh& mesh = *tessellation.refinement()->mesh;
  const GridLayout* grids = tessellation.grids();
  const bool at_corners = !grids && kind.kind == ValueKind::kFaceVarying;
  const std::size_t count = grids        ? grids->points.size()
                            : at_corners ? 3 * mesh.triangles().size()
                                         : mesh.point_count();
  Primvar<T> result{at_corners ? Interpolation::kFaceVarying : Interpolation::kVertex, authored.segments, {}};
  result.values.resize(count * key_count(authored.segments));
  std::vector<const float*> from;
  std::vector<float*> to;
  for (std::uint32_t key = 0; key < key_count(authored.segments); ++key) {
    from.push_back(reinterpret_cast<const float*>(authored.values.data() + key * value_count));
    to.push_back(reinterpret_cast<float*>(result.values.data() + key * count));
  }
  const auto width = std::uint32_t(sizeof(T) / sizeof(float));
  if (grids) {
    mesh.at_grid_points(kind, width, from, to);
  } else {
    at_corners ? mesh.at_corners(kind, width, from, to) : mesh.at_points(kind, width, from, to);
  }
  return result;
}

template <typename T>
Primvar<T> refined(const PrimvarInput<T>& input, const PrimvarMap& map, PrimvarTrack<T> track,
                   const Tessellation& mesh, const std::string& attribute) {
  const std::size_t count = input.values.size();
  switch (map.interpolation) {
    case Interpolation::kVertex: {
      const bool varying = input.interpolation == "varying";
      return refined({varying ? ValueKind::kVarying : ValueKind::kVertex, 0}, map.source.size(),
                     gathered(map.interpolation, map.source, track, count), mesh);
    }
    case Interpolation::kFaceVarying: {
      const std::uint32_t channel = mesh.refinement()->channels.at(attribute);
      const Primvar<T> values{map.interpolation, track.segments, std::move(track.values)};
      return refined({ValueKind::kFaceVarying, channel}, count, values, mesh);
    }
    default:
      return gathered(map.interpolation, map.source, track, count);
  }
}

}  // namespace

template <typename T>
Primvar<T> flattened(const PrimvarInput<T>& input, const Tessellation& mesh, const std::string& attribute,
                     PrimLog& log, std::uint32_t max_segments) {
  if (input.values.empty()) return {};
  const auto bad = std::ranges::find_if(input.values, [](const T& value) { return !is_color(value); });
  if (bad != input.values.end()) {
    log.reject(attribute,
               message("value ", bad - input.values.begin(),
                       " is not finite or too large; expected finite numbers of at most 65504 in size"));
    return {};
  }
  std::optional<PrimvarMap> map =
      map_primvar(input.interpolation, input.values.size(), input.indices, mesh.polygons(), attribute, log);
  if (!map) return {};
  PrimvarTrack<T> track = fit_primvar(input, max_segments, attribute, log);
  if (mesh.refinement()) {
    if (map->interpolation == Interpolation::kTriangle) map->source = of_faces(mesh.faces(), input.indices);
    return refined(input, *map, std::move(track), mesh, attribute);
  }
  return gathered(map->interpolation, map->source, track, input.values.size());
}

template Primvar<Vec3f> flattened(const PrimvarInput<Vec3f>&, const Tessellation&, const std::string&,
                                  PrimLog&, std::uint32_t);
template Primvar<float> flattened(const PrimvarInput<float>&, const Tessellation&, const std::string&,
                                  PrimLog&, std::uint32_t);

}  // namespace msbvh::translate
