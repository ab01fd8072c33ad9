// A frame's values to its Scene: samples what moves as densely as it needs, binds materials, and hands
// everything to the translator, in one order.
#pragma once

#include <memory>
#include <vector>

#include "delegate/translate/frame/frame_input.h"
#include "delegate/translate/look/texture_source.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {

struct AssembledFrame {
  std::shared_ptr<const Scene> scene;
  std::vector<Diagnostic> diagnostics;
  std::vector<TrackReport> tracks;
  Vec3d origin;        // of the frame's world, in stage space
  bool empty = false;  // there is nothing that could be seen
};

// Whatever is wrong with a prim leaves a Diagnostic, and the rest is there. Throws Error for a camera or
// settings that cannot be used. `refinements` as of Translator.
AssembledFrame assemble_frame(const FrameInput& input, const TranslatorSettings& settings,
                              const TextureSource& textures,
                              std::shared_ptr<RefinementCache> refinements = nullptr);

// Around what a shape draws over the shutter, in its own space.
Box3d box_of(const MeshInput& mesh);

}  // namespace msbvh::translate
