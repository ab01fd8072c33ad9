// Instancers: native instances and point instancers, nested to any depth.
#pragma once

#include <memory>
#include <pxr/imaging/hd/instancer.h>
#include <string>
#include <utility>
#include <vector>

#include "delegate/hydra/typed_values.h"
#include "delegate/translate/frame/frame_input.h"

namespace msbvh::hydra {

// How the instances of a prototype stand in the world.
struct Placed {
  std::vector<translate::PlacedLevel> levels{};  // the innermost first
  std::vector<VtIntArray> indices{};  // of each instancer on the way out: what shares them, shares all
  // One colour an instance where the innermost instancer that has some says so: at the frame, and over the
  // shutter where they change.
  std::vector<Vec3f> colors{};
  std::vector<std::pair<double, std::vector<Vec3f>>> color_samples{};
  bool visible = true;
  translate::Visibility shown{};  // over the shutter, where the host says so

  std::size_t count() const;
};

class Instancer : public HdInstancer {
 public:
  using HdInstancer::HdInstancer;

  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) override;

  // Those of one prototype: the path of a shape, of a light, or of an instancer inside this one. Reads what
  // is stale. Borrows this instancer's arrays until the next call with another shutter. For one thread at a
  // time.
  Placed place(const SdfPath& prototype, const Shutter& shutter, Diagnostics& said);

 private:
  void pull(const Shutter& shutter, Diagnostics& said);
  void pull_arrays(HdSceneDelegate& delegate, Diagnostics& said);
  std::string fault_of(const VtIntArray& indices) const;
  void add_colors(const VtIntArray& indices, Placed& placed) const;
  translate::PlacedLevel own_level(const VtIntArray& indices, Diagnostics& said) const;
  // Into a placement that ends here, the levels of the instancer around this one.
  void add_parents(Placed& placed, const Shutter& shutter, Diagnostics& said);

  HdDirtyBits stale_ = 0;
  bool read_ = false, visible_ = true;
  translate::Visibility shown_;
  Shutter shutter_;
  std::size_t count_ = 0;
  translate::MotionPointer whole_, matrices_;  // of all of it; of its instances, or null
  TypedValues<VtVec3fArray> translations_, scales_, velocities_, accelerations_, angular_velocities_, colors_;
  TypedValues<VtQuatfArray> rotations_;
  std::shared_ptr<translate::PointInstancerInput> arrays_;  // null: there are none
};

}  // namespace msbvh::hydra
