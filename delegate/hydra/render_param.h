// What the prims of a delegate share: who is there, and what has been edited since.
//
// Prims hold values; the render thread sees none of them. It renders a Scene that the render pass has made of
// them on the host's thread, between Sync and the next edit, and that never changes. So an edit stops
// nothing: it raises a counter, and the next execution of a render pass makes the next Scene.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <pxr/imaging/hd/renderDelegate.h>
#include <pxr/imaging/hd/types.h>
#include <pxr/usd/sdf/path.h>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delegate/hydra/api_version.h"
#include "delegate/translate/frame/shutter.h"

namespace msbvh::hydra {

class Jobs;
class Shape;
class Light;
class Material;
using translate::Shutter;

// What has been edited, by what it costs. Counters only rise.
struct Edits {
  std::uint64_t cameras = 0;     // another view, or another shutter
  std::uint64_t transforms = 0;  // of shapes and instancers
  std::uint64_t points = 0;
  std::uint64_t topology = 0;  // and shapes that come and go
  std::uint64_t looks = 0;     // primvars, materials, visibility
  std::uint64_t lights = 0;
  std::uint64_t buffers = 0;   // that are allocated anew
  std::uint64_t settings = 0;  // render settings prims

  bool operator==(const Edits&) const = default;
};

class RenderParam : public HdRenderParam {
 public:
  explicit RenderParam(std::shared_ptr<Jobs> jobs) : jobs_(std::move(jobs)) {}

  // From Sync and Finalize, on any thread.
  void note_shape(Shape& shape, HdDirtyBits bits);
  void forget_shape(Shape& shape);
  void note_light(Light& light);
  void forget_light(Light& light);
  void note_material(Material& material);
  void forget_material(Material& material);
  void note_instancer(HdDirtyBits bits);
  void note_camera();
  void note_render_tag();
  void note_buffer();
  void note_settings();

  Edits edits() const;
  // In the order of their paths, which is the order of the Scene. For the host's thread between Syncs.
  std::vector<Shape*> shapes() const;
  std::vector<Light*> lights() const;
  std::vector<Material*> materials() const;

  // Of the camera that was rendered last: what is synced reads its values over it at once. None yet: shapes
  // are read when the first render pass is executed.
  std::optional<Shutter> last_shutter() const;
  void set_last_shutter(const Shutter& shutter);

  // The host's thread's.
  const std::shared_ptr<Jobs>& jobs() const { return jobs_; }

  // Whether something has been said before: what cannot be drawn is named once.
  bool is_news(const std::string& text);

 private:
  mutable std::mutex mutex_;
  std::map<SdfPath, Shape*> shapes_;
  std::map<SdfPath, Light*> lights_;
  std::map<SdfPath, Material*> materials_;
  std::optional<Shutter> last_shutter_;
  std::set<std::string> said_;
  Edits edits_;
  std::shared_ptr<Jobs> jobs_;
};

}  // namespace msbvh::hydra
