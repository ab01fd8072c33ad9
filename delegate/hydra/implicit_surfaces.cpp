// Spheres, cubes, cones, cylinders, capsules and planes as subdivided meshes: a scene index that hosts put in
// front of the delegate, by plugInfo.json.
#include <pxr/imaging/hd/retainedDataSource.h>
#include <pxr/imaging/hd/sceneIndexPlugin.h>
#include <pxr/imaging/hd/sceneIndexPluginRegistry.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/imaging/hdsi/implicitSurfaceSceneIndex.h>

#include "delegate/hydra/api_version.h"

PXR_NAMESPACE_OPEN_SCOPE

class HdMsbvh_ImplicitSurfaceSceneIndexPlugin final : public HdSceneIndexPlugin {
 protected:
  HdSceneIndexBaseRefPtr _AppendSceneIndex(const HdSceneIndexBaseRefPtr& scene,
                                           const HdContainerDataSourceHandle& args) override {
    return HdsiImplicitSurfaceSceneIndex::New(scene, args);
  }
};

TF_REGISTRY_FUNCTION(TfType) {
  HdSceneIndexPluginRegistry::Define<HdMsbvh_ImplicitSurfaceSceneIndexPlugin>();
}

TF_REGISTRY_FUNCTION(HdSceneIndexPlugin) {
  const HdDataSourceBaseHandle mesh =
      HdRetainedTypedSampledDataSource<TfToken>::New(HdsiImplicitSurfaceSceneIndexTokens->toMesh);
  const HdContainerDataSourceHandle args = HdRetainedContainerDataSource::New(
      HdPrimTypeTokens->sphere, mesh, HdPrimTypeTokens->cube, mesh, HdPrimTypeTokens->cone, mesh,
      HdPrimTypeTokens->cylinder, mesh, HdPrimTypeTokens->capsule, mesh, HdPrimTypeTokens->plane, mesh);
  HdSceneIndexPluginRegistry::GetInstance().RegisterSceneIndexForRenderer(
      "MSBVH", TfToken("HdMsbvh_ImplicitSurfaceSceneIndexPlugin"), args, 0,
      HdSceneIndexPluginRegistry::InsertionOrderAtStart);
}

PXR_NAMESPACE_CLOSE_SCOPE
