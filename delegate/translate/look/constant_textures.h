// Textures that are the same everywhere, as constants: a material that they alone drive is no textured one.
#pragma once

#include <string>

#include "delegate/translate/look/surface_look.h"

namespace msbvh::translate {

// Takes them, and the primvars that nothing else reads, out of the look. The first rows of each image are
// read, all of those whose rows are alike (core/texture/constant_image.h); what cannot be read stays, to be
// reported when it is drawn. Throws Error where `rendering_space` is no colour space.
void fold_constant_textures(SurfaceLook& look, const std::string& rendering_space);

// Whether anything reflects as a mirror does: unless the surface is nowhere, a presence of constant opacity
// 0. By UsdPreviewSurface's Fresnel term reflectance tends to 1 at grazing angles whatever the rest says.
bool reflects(const Material& material);

}  // namespace msbvh::translate
