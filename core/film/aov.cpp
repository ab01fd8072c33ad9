#include "core/film/aov.h"

namespace msbvh {

void AovSum::resolve(Aov aov, std::uint32_t count, float* out) const {
  const auto mean = [&](const Vec3d& sum) {
    const Vec3f v(sum * (1.0 / count));
    for (int c = 0; c < 3; ++c) out[c] = v[c];
  };
  switch (aov) {
    case Aov::kDepth:
      *out = depth;
      return;
    case Aov::kCameraDepth:
      *out = camera_depth;
      return;
    case Aov::kNeye:
      return mean(eye_normal);
    case Aov::kNormal:
      return mean(normal);
    case Aov::kAlbedo:
      return mean(albedo);
    case Aov::kPrimId:
    case Aov::kInstanceId:
    case Aov::kElementId:
      return;
  }
}

std::int32_t AovSum::id(Aov aov) const {
  if (aov == Aov::kPrimId) return prim;
  return aov == Aov::kInstanceId ? instance : element;
}

}  // namespace msbvh
