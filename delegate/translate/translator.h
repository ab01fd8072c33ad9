// From what a front-end has read to a Scene: the one code path that the command line and the Hydra plugin
// share.
//
// It checks the input, subtracts the frame's origin in double precision, triangulates, computes missing
// normals, and fits tracks: the fewest 2^k segments whose linear interpolation follows the samples within the
// motion tolerance, measured in pixels through the camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/box.h"
#include "core/geometry/subdivision/refinement_cache.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/light_groups.h"
#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/surface_look.h"
#include "delegate/translate/unreached.h"

namespace msbvh::translate {

// What displaced subdivision surfaces become. Patches take a fifth to a tenth of the bytes; triangles are
// traced 1.25 to 1.7 times as fast (docs/design/subdivision.md, "What was measured").
enum class Displaced : std::uint8_t { kNot, kAsTriangles, kAsPatches, kByMemory };

struct TranslatorSettings {
  std::uint32_t width = 960, height = 540;  // pixels, for the tolerance
  double motion_tolerance_pixels = 0.1;
  // How many times as far the motion of what lies wholly outside of the picture, throughout the shutter, may
  // stray: shadows and bounces alone show it. Not the camera's and the lights', nor that of a prototype's own
  // points; not where TrackChoice::segments says how many keys all have. 1: no further than the rest.
  double outside_tolerance = 8.0;
  std::uint32_t max_segments = kMaxSegments;
  TrackChoice choice{};     // which tracks may be used
  bool keep_faces = false;  // for the AOV elementId: which face each triangle is of
  // Whether TrackReport::shape_error_pixels is measured; takes a few times as long as refining the surfaces.
  bool measure_shape = false;
  // About how long the edges of a subdivided surface are in the picture; 0: cages are drawn as polygons.
  double edge_length_pixels = 1.0;
  CurveStyle curves = CurveStyle::kRibbon;
  // Surfaces whose materials say so.
  Displaced displaced = Displaced::kByMemory;
  // Of kByMemory: about as many bytes of trees as a frame's displaced surfaces may take as triangles, one
  // after the other; those that do not fit become patches.
  std::uint64_t displaced_triangle_bytes = 256ull << 20;
  // Of the render that the scene is for: what none of its rays can reach is left out (unreached.h). None:
  // nothing but what is hidden throughout the shutter, so that the scene serves any render.
  std::optional<std::uint32_t> max_bounces{};
  // Of the frame's world, in stage space; none: the camera's place when the shutter opens.
  std::optional<Vec3d> origin{};
};

// How a prim's motion was kept: the camera's, then one for each mesh, set of instances and light. For
// statistics and `msbvh motion`.
struct TrackReport {
  std::string path;
  std::string
      source{};  // what moves it: camera, points, velocities, accelerations, transform, instances, light
  std::string rule{};  // which of USD's rules decided, in words
  std::uint32_t segments = 0;
  std::uint32_t degree = 1;
  bool moving_transform = false;  // a still mesh under a moving transform, or instances; not baked
  bool time_remap = false;        // keys at the breakpoints of the motion, not at even times
  bool hidden_partly = false;     // visible for a part of the shutter
  double error_pixels = 0.0;      // largest deviation found from the stage's motion
  // That error_pixels is held to: the motion tolerance or, of what is outside of the picture, so many times
  // it.
  double tolerance_pixels = 0.0;
  // Whether error_pixels is of what is outside of the picture: of all that is in one report where nothing of
  // it is seen, or of an instance that misses its tolerance.
  bool error_outside = false;
  std::size_t outside = 0;  // of `count`: that move, wholly outside of the picture throughout the shutter
  // Of those: that took fewer keys than the motion tolerance asks for. After Translator::finish(): and that a
  // ray can reach.
  std::size_t coarser = 0;
  std::size_t keys_saved =
      0;  // by all of these together; of many instances that have reports of their own, 0
  // How far what is drawn of a mesh strays from its true surface in the picture, at most, in pixels
  // (stray/stray.h). Not measured: where TranslatorSettings::measure_shape is off, of cameras and lights, of
  // displaced polygons, of NURBS patches, and of implicit shapes whose points a skeleton moves. Of instances:
  // only where their prototype's size in the picture was not known when its meshes were added; else their
  // prototype's meshes have it.
  std::optional<double> shape_error_pixels{};
  std::size_t bytes = 0;  // of the controls
  // Of instances, once for each place that outer levels put a prim at; 0 of a prototype's mesh, which those
  // of its instances count.
  std::size_t count = 1;

  void set_form(const TrackForm& form, const TimeRemap& own) {
    segments = form.segments;
    degree = form.degree;
    time_remap = !own.is_shutter();
  }
  std::uint32_t controls() const { return TrackForm{segments, degree}.controls(); }
};

class Translator {
 public:
  // The camera comes first: tolerances are measured through it, and the frame's origin is its position at the
  // shutter's centre. Throws Error for a camera that cannot be used.
  // `refinements`: cages that earlier frames have refined, for this one and the next; null: this frame's
  // alone.
  Translator(const CameraInput& camera, const TranslatorSettings& settings,
             std::shared_ptr<RefinementCache> refinements = nullptr);
  ~Translator();

  // Meshes, prototypes and instances that are wrong are left out and leave a Diagnostic of severity kError;
  // nothing throws for bad data.
  void add_mesh(const MeshInput& input);  // into the world
  // Into a prototype made with begin_prototype(); in the prototype's space, no origin subtracted.
  void add_prototype_mesh(std::uint32_t prototype, const MeshInput& input);
  // `pixels_per_unit`: of the instance that is seen largest, see pixels_per_unit(); 0: not known, and its
  // motion is followed as if it filled the image.
  std::uint32_t begin_prototype(const std::string& path, double pixels_per_unit = 0.0);
  // How many pixels a unit of a prototype's space covers at most in any of its instances, at the sample
  // times. `box` encloses the prototype.
  double pixels_per_unit(const InstancesInput& input, const Box3d& box) const;
  // After the prototype's meshes, whose extent the tolerance is measured on.
  void add_instances(const InstancesInput& input);
  // Before the meshes that are bound to it.
  std::uint32_t add_material(SurfaceLook look, std::optional<Displacement> displacement = {});
  // A primvar that is kept of every prim which brings it along, whatever its materials read: for the AOV st.
  // Before the meshes.
  void keep_primvar(const std::string& name);
  // A mesh light is placed with the scene's end, when it is known where its mesh stands.
  void add_light(const LightInput& input);
  // By the path of a prim, or of what places instances: its light group (core/scene/light.h), or those of its
  // instances. Of all others 0.
  void set_light_groups(LightGroups groups);

  // Whether the scene has geometry that can be seen.
  bool empty() const;
  // Meshes without a face to draw, which are no error: an exporter writes them for effects that have not
  // started.
  std::size_t empty_meshes() const;
  const std::vector<Diagnostic>& diagnostics() const;
  const std::vector<TrackReport>& tracks() const;
  // Of the frame's world, in stage space.
  Vec3d origin() const;

  // The finished scene; the translator is empty afterwards.
  std::shared_ptr<const Scene> finish();
  // Prims that no ray can reach, and that are not in the scene therefore; after finish().
  const std::vector<LeftOut>& left_out() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh::translate
