// A camera as it is looked up over the shutter, to the translator's camera: checks of its optics, its lens,
// the window that an image of another shape shows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/look/optics.h"
#include "delegate/translate/sample/pixel_size.h"

namespace msbvh::translate {

// Apertures by which an aperture's offset may shift it: beyond, single precision has no pixels left to tell
// apart.
inline constexpr double kLargestOffset = 1e6;

// A camera at one time.
struct CameraMoment {
  double time01 = 0.0;
  Matrix4d world_from_camera{};
  Optics optics;
  ClipRange clip;
};

// The part of a window that an image has pixels of, as shares of its width and height from the left and from
// the bottom: 0 to 1 is all of it, more is overscan.
struct WindowPart {
  double left = 0.0, right = 1.0, bottom = 0.0, top = 1.0;
  bool operator==(const WindowPart&) const = default;
};

// How a camera's window becomes that of an image.
struct Framing {
  double image_aspect = 1.0;  // width / height of the whole image, in the scene
  AspectPolicy policy = AspectPolicy::kExpandAperture;
  WindowPart part{};
  bool operator==(const Framing&) const = default;
};

// Throws Error that names the camera, its attribute, what was found and what is expected.
void check_optics(const std::string& path, const Optics& optics, const ClipRange& clip);

// UsdGeomCamera: an fStop of 0 turns depth of field off, and so does a focusDistance of 0, which is what it
// is where nobody has authored one. What makes no sense is a pinhole too, with a warning. A lens that is
// there for a part of the shutter only is taken at the frame: from a pinhole to an f-number there is no way
// that would not pass the widest of all lenses. One lens a moment.
std::vector<Lens> lenses_of(const std::string& path, const Optics& at_frame, std::span<const Optics> over,
                            std::vector<Diagnostic>& diagnostics);

// Of a camera that may change its course at these times: with the instants before them where it is `held`,
// since it jumps there.
std::vector<double> course_breakpoints01(std::span<const double> breakpoints01, bool held);

// `over` are moments at increasing times, dense as CameraInput wants them; one where nothing changes. Throws
// Error for optics that make no image.
CameraInput camera_input(const std::string& path, const CameraMoment& at_frame,
                         std::span<const CameraMoment> over, std::optional<std::vector<double>> breakpoints01,
                         const Framing& framing, std::vector<Diagnostic>& diagnostics);

// Of an image that the camera makes, in the world: the smallest over the shutter.
PixelSize pixel_size_of(const CameraInput& camera, std::uint32_t width, std::uint32_t height);

// What a projection matrix shows: OpenGL's, in the row-vector convention, without a lens.
struct Projected {
  Projection projection = Projection::kPerspective;
  ScreenWindow window;
  ClipRange clip;
};
// None where it is neither a perspective nor an orthographic one.
std::optional<Projected> projected_by(const Matrix4d& projection);

}  // namespace msbvh::translate
