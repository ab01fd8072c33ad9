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

// The camera's, and that of a shape: scaled by its motion:blurScale.
struct ShapeShutters {
  Shutter camera, shape;
};

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
  // is stale. Native instances move by the shape's shutter (USD: motion:blurScale inside an instance counts
  // for the instance's motion too), those of a point instancer by the camera's. For one thread at a time.
  Placed place(const SdfPath& prototype, const ShapeShutters& shutters, Diagnostics& said);

 private:
  // Its values over one shutter.
  struct Values {
    Shutter shutter;
    translate::Visibility shown;
    translate::MotionPointer whole, matrices;  // of all of it; of its instances, or null
    TypedValues<VtVec3fArray> translations, scales, velocities, accelerations, angular_velocities, colors;
    TypedValues<VtQuatfArray> rotations;
    std::size_t count = 0;
    bool by_arrays = false;
    translate::PointInstancerInput arrays;  // where by_arrays; borrows from the above
  };
  using ValuesPointer = std::shared_ptr<Values>;

  // Levels keep what they borrow.
  ValuesPointer values_over(const Shutter& shutter, Diagnostics& said);
  ValuesPointer pulled(const Shutter& shutter, Diagnostics& said) const;
  void pull_arrays(Values& values, Diagnostics& said) const;
  translate::PlacedLevel own_level(const ValuesPointer& values, const VtIntArray& indices,
                                   Diagnostics& said) const;
  // Into a placement that ends here, the levels of the instancer around this one.
  void add_parents(Placed& placed, const ShapeShutters& shutters, Diagnostics& said);

  HdDirtyBits stale_ = 0;
  bool visible_ = true;
  std::vector<ValuesPointer> known_;  // by shutter
};

}  // namespace msbvh::hydra
