// Implicit prims of a frame: the mesh that stands for one, with as many sides as its size in pixels asks for.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "delegate/translate/frame/frame_input.h"
#include "delegate/translate/sample/pixel_size.h"
#include "delegate/translate/shape/implicit_shape.h"
#include "delegate/translate/shape/sides.h"

namespace msbvh::translate {

class FrameImplicit {
 public:
  // Nothing, with an error, for parameters that are no numbers (check_parameters). Borrows `input`.
  static std::optional<FrameImplicit> make(const ImplicitFrameInput& input, PrimLog& log);

  // Over the shutter, in its own space.
  Box3d box() const { return shape_.box(kSideCounts.front()); }
  // Sets topology, points, normals and stray of a mesh, which borrows them from this. `motion`: to the space
  // that pixels are measured in.
  void form(const TransformSamples& motion, const PixelSize& pixel, MeshInput& mesh);

 private:
  FrameImplicit(const ImplicitFrameInput& input, ImplicitShape shape)
      : input_(&input), shape_(std::move(shape)) {}

  const ImplicitFrameInput* input_;
  ImplicitShape shape_;
  Surface surface_;
  std::deque<std::vector<Vec3f>> poses_;
};

}  // namespace msbvh::translate
