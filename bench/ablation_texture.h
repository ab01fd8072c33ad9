// An image for the scenes of the ablation, as textures are read from files alone.
#pragma once

#include <string>

namespace msbvh::bench {

// The path of a picture of 256 x 256 texels, 8 bits of sRGB, three channels, which no two neighbours share.
// It is written to the folder for temporary files when it is first asked for, and removed when the process
// ends. Throws Error.
const std::string& texture_file();

}  // namespace msbvh::bench
