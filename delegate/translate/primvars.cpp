#include "delegate/translate/primvars.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

template <typename T>
Primvar<T> flattened(const PrimvarInput<T>& input, const Triangulation& mesh, const std::string& attribute,
                     PrimLog& log, std::uint32_t max_segments) {
  if (input.values.empty()) return {};
  const auto bad = std::ranges::find_if(input.values, [](const T& value) { return !is_color(value); });
  if (bad != input.values.end()) {
    log.reject(attribute,
               message("value ", bad - input.values.begin(),
                       " is not finite or too large; expected finite numbers of at most 65504 in size"));
    return {};
  }
  const std::optional<PrimvarMap> map =
      map_primvar(input.interpolation, input.values.size(), input.indices, mesh, attribute, log);
  if (!map) return {};
  const PrimvarTrack<T> track = fit_primvar(input, max_segments, attribute, log);
  Primvar<T> result;
  result.interpolation = map->interpolation;
  result.segments = track.segments;
  result.values.reserve(map->source.size() * key_count(track.segments));
  for (std::uint32_t key = 0; key < key_count(track.segments); ++key) {
    const T* values = track.values.data() + key * input.values.size();
    for (const std::uint32_t source : map->source) result.values.push_back(values[source]);
  }
  return result;
}

template Primvar<Vec3f> flattened(const PrimvarInput<Vec3f>&, const Triangulation&, const std::string&,
                                  PrimLog&, std::uint32_t);
template Primvar<float> flattened(const PrimvarInput<float>&, const Triangulation&, const std::string&,
                                  PrimLog&, std::uint32_t);

}  // namespace msbvh::translate
