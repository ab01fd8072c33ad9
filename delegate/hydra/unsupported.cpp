#include "delegate/hydra/unsupported.h"

#include <algorithm>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/tokens.h>

#include "delegate/hydra/render_param.h"

namespace msbvh::hydra {

void UnsupportedPrims::PrimsAdded(const HdSceneIndexBase&, const AddedPrimEntries& entries) {
  for (const AddedPrimEntry& entry : entries) {
    const TfToken& type = entry.primType;
    if (!HdPrimTypeIsGprim(type) && !HdPrimTypeIsLight(type)) continue;
    if (std::find(supported_.begin(), supported_.end(), type) != supported_.end()) continue;
    if (param_.is_news("type " + type.GetString()))
      TF_WARN("%s: prims of type %s are not drawn", entry.primPath.GetText(), type.GetText());
  }
}

}  // namespace msbvh::hydra
