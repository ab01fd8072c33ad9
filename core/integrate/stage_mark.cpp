#include "core/integrate/stage_mark.h"

namespace msbvh {

const char* stage_name(Stage stage) {
  switch (stage) {
    case Stage::kNone:
      return "none";
    case Stage::kGenerate:
      return "generate";
    case Stage::kClosest:
      return "closest";
    case Stage::kOpacity:
      return "opacity";
    case Stage::kSurface:
      return "surface";
    case Stage::kLooks:
      return "looks";
    case Stage::kAovs:
      return "AOVs";
    case Stage::kScatter:
      return "scatter";
    case Stage::kDirect:
      return "direct";
    case Stage::kAreaLights:
      return "area lights";
    case Stage::kDome:
      return "dome light";
    case Stage::kAccumulate:
      return "accumulate";
  }
  return "unknown stage";
}

}  // namespace msbvh
