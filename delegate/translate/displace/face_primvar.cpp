#include "delegate/translate/displace/face_primvar.h"

#include <algorithm>

#include "delegate/translate/cage.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/value_track.h"

namespace msbvh::translate {
namespace {

std::vector<Vec3f> values_at(const PrimvarInput<Vec3f>& primvar, double time01) {
  std::vector<Vec3f> values(primvar.values.begin(), primvar.values.end());
  if (primvar.samples.empty()) return values;
  std::vector<double> times01;
  for (const PrimvarSample<Vec3f>& sample : primvar.samples) {
    if (sample.values.size() != values.size()) return values;
    times01.push_back(sample.time01);
  }
  const Mix mix = mix_at(times01, time01);
  for (std::size_t i = 0; i < values.size(); ++i) {
    Vec3d sum;
    for (const Share& share : mix) sum += Vec3d(primvar.samples[share.sample].values[i]) * share.weight;
    values[i] = Vec3f(sum);
  }
  return values;
}

std::vector<Vec3f> gathered(const std::vector<Vec3f>& values, std::span<const int> indices) {
  if (indices.empty()) return values;
  std::vector<Vec3f> result;
  result.reserve(indices.size());
  for (const int index : indices) result.push_back(values[std::size_t(index)]);
  return result;
}

}  // namespace

std::optional<FacePrimvar> FacePrimvar::at(const NamedPrimvar& named, double time01, const Tessellation& mesh,
                                           PrimLog& log) {
  const PrimvarInput<Vec3f>& primvar = named.primvar;
  PrimLog optional = log.of_optional_part();
  const std::optional<PrimvarMap> map =
      map_primvar(primvar.interpolation, primvar.values.size(), primvar.indices, mesh.polygons(),
                  full_name(named), optional);
  if (!map) return std::nullopt;
  FacePrimvar result(mesh, map->interpolation);
  result.values_ = values_at(primvar, time01);
  const Refinement* refinement = mesh.refinement();
  if (refinement && map->interpolation == Interpolation::kFaceVarying) {
    result.kind_ = {ValueKind::kFaceVarying, refinement->channels.at(full_name(named))};
  } else {
    result.values_ = gathered(result.values_, primvar.indices);
    if (primvar.interpolation == "varying") result.kind_ = {ValueKind::kVarying, 0};
  }
  return result;
}

void FacePrimvar::at_squares(std::uint32_t cage_face, std::uint32_t face,
                             std::span<const SquareLattice> squares, Vec3d* out) const {
  const bool varies =
      interpolation_ == Interpolation::kVertex || interpolation_ == Interpolation::kFaceVarying;
  if (!varies) {
    const Vec3d value(values_[interpolation_ == Interpolation::kConstant ? 0 : face]);
    for (const SquareLattice& square : squares) out = std::fill_n(out, square.points.size(), value);
    return;
  }
  FaceSurface surface(mesh_->refinement()->mesh->surface(), cage_face, kind_);
  surface.set_values(&values_.data()->x, 3);
  for (const SquareLattice& square : squares) {
    for (const FacePoint& p : square.points) surface.evaluate(p.square, p.s, p.t, &(out++)->x);
  }
}

Vec3d FacePrimvar::at_corner(std::uint32_t face, std::uint32_t corner, std::uint32_t point) const {
  switch (interpolation_) {
    case Interpolation::kConstant:
      return Vec3d(values_[0]);
    case Interpolation::kTriangle:
      return Vec3d(values_[face]);
    case Interpolation::kVertex:
      return Vec3d(values_[point]);
    case Interpolation::kFaceVarying:
      break;
  }
  return Vec3d(values_[corner]);
}

}  // namespace msbvh::translate
