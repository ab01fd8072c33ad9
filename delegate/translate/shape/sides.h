// How many sides implicit shapes have: as many as their size in pixels asks for.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/box.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/sample/pixel_size.h"
#include "delegate/translate/shape/implicit_type.h"

namespace msbvh::translate {

// How many sides a shape may have around its axis, all of them multiples of 4 (surface.h). The last takes
// 147,456 triangles a sphere and strays by a tenth of a pixel at a radius of 1,500 pixels.
inline constexpr std::array kSideCounts = {8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384};
// Where nobody knows how large a shape is seen.
inline constexpr int kUnmeasuredSides = 48;

// Pixels by which a shape may lie inside of the true one, by the name that usdrecord's --complexity gives it.
struct Silhouette {
  std::string_view complexity;
  double pixels;
};
inline constexpr Silhouette kSilhouettes[] = {
    {"low", 0.4}, {"medium", 0.2}, {"high", 0.1}, {"veryhigh", 0.05}};

// How far a shape of radius 1 with n sides may lie inside of the true one. A chord of a circle lies
// 1 - cos(pi / n) inside; the middle of a sphere's face twice as far, since it is curved both ways.
double stray_of(int sides);
// The same for a shape of that kind, exactly: how far its faces lie off the true shape at most, with `sides`
// around the axis, a multiple of 4. A cylinder's and a cone's chords lie 1 - cos(pi / n) inside. The faces of
// a sphere (or of a capsule's ends) that lie farthest inside are those beside the equator: their edges'
// middles lie on an ellipse of half axes cos(pi / n) and 1, and the chord of it that starts at the equator
// passes the centre at cos(pi / n) / sqrt(1 + sin^2(pi / n)). Flat shapes: 0.
double stray_of(ImplicitKind kind, int sides);

// The fewest of `counts`, which increase, for which shapes of these radii in pixels stray by
// `silhouette_pixels` at most; the last where none does. NaN: kUnmeasuredSides.
std::vector<int> sides_for(std::span<const double> radii_pixels, double silhouette_pixels,
                           std::span<const int> counts = kSideCounts);

// What a matrix stretches a length by is at most `most` and at least `least`: Gershgorin's circles of A A^T,
// exact where the rows are orthogonal, as those of rotations and scales are.
struct Stretch {
  double most, least;
};
Stretch stretch_of(const Matrix4d& matrix);

// The largest radii in pixels of `count` shapes that have one radius and one box in their own space, under
// matrices [time][count] to the space that pixels are measured in. NaN (not known) where the radius is 0 or
// a matrix has an element that is not finite.
std::vector<double> radii_in_pixels(ImplicitKind kind, double radius, const Box3d& box,
                                    std::span<const Matrix4d> matrices, std::size_t count,
                                    const PixelSize& pixel_size);

}  // namespace msbvh::translate
