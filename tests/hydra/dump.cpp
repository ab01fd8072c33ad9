#include "tests/hydra/dump.h"

#include <algorithm>
#include <array>
#include <ostream>
#include <pxr/base/tf/stringUtils.h>
#include <pxr/base/vt/array.h>
#include <pxr/base/vt/value.h>
#include <pxr/imaging/hd/dataSource.h>
#include <pxr/imaging/hd/dataSourceLocator.h>
#include <string>
#include <vector>

PXR_NAMESPACE_USING_DIRECTIVE

namespace msbvh::testing {
namespace {

constexpr std::size_t kLongest = 160;

// Beside these nothing changes what moves and when.
const std::array<const char*, 12> kLocators{"xform",  "visibility", "primvars",       "instancerTopology",
                                            "camera", "mesh",       "basisCurves",    "instancedBy",
                                            "sphere", "cube",       "extComputation", "sceneGlobals"};

std::string text_of(const VtValue& value) {
  std::string text = TfStringify(value);
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return value.IsArrayValued() ? std::to_string(value.GetArraySize()) + " x " + text : text;
}

struct Printer {
  float open, close;
  std::ostream& out;

  void print(const std::string& prim, const HdDataSourceLocator& locator,
             const HdDataSourceBaseHandle& source) const {
    if (const auto container = HdContainerDataSource::Cast(source)) {
      TfTokenVector names = container->GetNames();
      std::sort(names.begin(), names.end());
      for (const TfToken& name : names) print(prim, locator.Append(name), container->Get(name));
    } else if (const auto list = HdVectorDataSource::Cast(source)) {
      for (std::size_t i = 0; i < list->GetNumElements(); ++i)
        print(prim, locator.Append(TfToken(std::to_string(i))), list->GetElement(i));
    } else if (const auto sampled = HdSampledDataSource::Cast(source)) {
      std::vector<float> times;
      if (!sampled->GetContributingSampleTimesForInterval(open, close, &times)) times.clear();
      out << prim << " " << locator.GetString() << ": times "
          << text_of(VtValue(VtArray<float>(times.begin(), times.end()))) << ": "
          << text_of(sampled->GetValue(open));
      if (!times.empty())
        out << " | " << text_of(sampled->GetValue(0.0f)) << " | " << text_of(sampled->GetValue(close));
      out << "\n";
    }
  }

  void print(const HdSceneIndexBase& scene, const SdfPath& path) const {
    const HdSceneIndexPrim prim = scene.GetPrim(path);
    for (const char* name : kLocators) {
      const TfToken token(name);
      if (!prim.dataSource) continue;
      print(path.GetString() + " " + prim.primType.GetString(), HdDataSourceLocator(token),
            prim.dataSource->Get(token));
    }
    SdfPathVector children = scene.GetChildPrimPaths(path);
    std::sort(children.begin(), children.end());
    for (const SdfPath& child : children) print(scene, child);
  }
};

}  // namespace

void dump(const HdSceneIndexBase& scene, float open_frames, float close_frames, std::ostream& out) {
  Printer{open_frames, close_frames, out}.print(scene, SdfPath::AbsoluteRootPath());
}

}  // namespace msbvh::testing
