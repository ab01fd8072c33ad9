#include "delegate/translate/frame/frame_implicit.h"

#include <array>

namespace msbvh::translate {
namespace {

// usdrecord's complexity `high`, which is ours.
constexpr double kSilhouettePixels = 0.1;

std::vector<Vec3f> rounded(const std::vector<Vec3d>& points) {
  std::vector<Vec3f> result;
  result.reserve(points.size());
  for (const Vec3d& point : points) result.push_back(Vec3f(point));
  return result;
}

}  // namespace

std::optional<FrameImplicit> FrameImplicit::make(const ImplicitFrameInput& input, PrimLog& log) {
  std::optional<ImplicitShape> shape = ImplicitShape::make(input.shape, log);
  if (!shape) return std::nullopt;
  return FrameImplicit(input, std::move(*shape));
}

void FrameImplicit::form(const TransformSamples& motion, const PixelSize& pixel, MeshInput& mesh) {
  const std::vector<double> radii =
      radii_in_pixels(shape_.kind(), shape_.radius(), box(), motion.matrices, 1, pixel);
  const int sides = sides_for(radii, kSilhouettePixels).front();
  surface_ = shape_.surface(0, sides);
  poses_.clear();
  mesh.points = {};
  mesh.points.held = input_->held;
  // The values at the frame come first.
  for (std::size_t i = 0; i < input_->times01.size(); ++i) {
    poses_.push_back(rounded(shape_.surface(i + 1, sides).points));
    mesh.points.samples.push_back({input_->times01[i], poses_.back()});
  }
  if (poses_.empty()) {
    poses_.push_back(rounded(surface_.points));
    mesh.points.samples.push_back({0.0, poses_.back()});
  }
  mesh.face_vertex_counts = surface_.counts;
  mesh.face_vertex_indices = surface_.indices;
  mesh.computed_points = true;
  mesh.subdivision.scheme = "none";
  const ImplicitType& type = implicit_type(shape_.kind());
  mesh.stray = type.smooth ? shape_.radius() * stray_of(shape_.kind(), sides) : 0.0;
  mesh.computed_normals = type.smooth ? Normals::kSmooth : Normals::kFaceted;
}

}  // namespace msbvh::translate
