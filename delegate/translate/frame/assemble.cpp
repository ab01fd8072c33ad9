#include "delegate/translate/frame/assemble.h"

#include <algorithm>

#include "delegate/translate/box_corners.h"
#include "delegate/translate/frame/bound_materials.h"
#include "delegate/translate/frame/camera_moments.h"
#include "delegate/translate/frame/frame_implicit.h"
#include "delegate/translate/frame/held_parts.h"
#include "delegate/translate/frame/motions.h"
#include "delegate/translate/frame/primvar_policy.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr double kSmallest = 1e-30;

class Assembler {
 public:
  Assembler(const FrameInput& input, const TranslatorSettings& settings, const TextureSource& textures,
            std::shared_ptr<RefinementCache> refinements)
      : input_(input),
        tolerance_(settings.motion_tolerance_pixels),
        translator_(input.camera, settings, std::move(refinements)),
        materials_(input.materials, textures, translator_),
        pixel_(pixel_size_of(input.camera, settings.width, settings.height)) {}

  AssembledFrame assembled() {
    for (const FrameGroup& group : input_.groups) {
      if (group.levels.empty()) add_to_world(group);
    }
    for (const FrameGroup& group : input_.groups) {
      if (!group.levels.empty() && group.count() > 0) add_instanced(group);
    }
    add_lights();
    return finished();
  }

 private:
  void add_to_world(const FrameGroup& group) {
    for (const FrameShape& shape : group.shapes) {
      add_shape(shape, pixel_, [&](const MeshInput& mesh) { translator_.add_mesh(mesh); });
    }
  }

  // In parts, where what holds changes within the shutter.
  template <typename Add>
  void add_shape(const FrameShape& shape, const PixelSize& pixel, const Add& add) {
    std::optional<FrameImplicit> implicit;
    if (shape.implicit) {
      PrimLog log(said_, shape.mesh.path);
      implicit = FrameImplicit::make(*shape.implicit, log);
      if (!implicit) return;
    }
    const Box3d box = implicit ? implicit->box() : box_of(shape.mesh);
    const std::vector<MotionSamples> samples =
        sample_motion(*shape.motion, std::span(&box, 1), pixel, tolerance_, shape.motion->held());
    if (samples.empty() || !samples.front().usable) {
      said_.push_back({Severity::kError, shape.mesh.path, "xformOpOrder",
                       "found a matrix with an element that is not finite or larger than 2^60; expected "
                       "finite numbers"});
      return;
    }
    const TransformSamples motion = samples.front().of(0);
    if (implicit) {
      FrameShape formed = shape;
      implicit->form(motion, pixel, formed.mesh);
      return add_formed(formed, motion, add);
    }
    add_formed(shape, motion, add);
  }

  template <typename Add>
  void add_formed(const FrameShape& shape, const TransformSamples& motion, const Add& add) {
    if (!holds_values(shape)) return add_part(shape, motion, add);
    PrimLog log(said_, shape.mesh.path);
    const ShapeParts parts = parts_of(shape, log);
    for (const FrameShape& part : parts.shapes) add_part(part, motion, add);
  }

  template <typename Add>
  void add_part(const FrameShape& shape, const TransformSamples& motion, const Add& add) {
    MeshInput mesh = shape.mesh;
    mesh.world_from_object = motion;
    std::vector<int> face_materials;
    materials_.bind(shape, mesh, face_materials);
    settle(mesh);
    add(mesh);
  }

  void settle(MeshInput& mesh) {
    PrimLog log(said_, mesh.path);
    settle_samples(mesh.display_color, "primvars:displayColor", log);
    settle_samples(mesh.display_opacity, "primvars:displayOpacity", log);
    settle_samples(mesh.round.widths, "widths", log);
    for (NamedPrimvar& each : mesh.named_primvars) settle_samples(each.primvar, "primvars:" + each.name, log);
  }

  // Empty for a shape that cannot be drawn; add_shape() says why.
  static Box3d bounds_of(const FrameShape& shape) {
    if (!shape.implicit) return box_of(shape.mesh);
    std::vector<Diagnostic> unsaid;
    PrimLog log(unsaid, shape.mesh.path);
    const std::optional<FrameImplicit> implicit = FrameImplicit::make(*shape.implicit, log);
    return implicit ? implicit->box() : Box3d();
  }

  // A prototype, followed as closely as that instance asks for which is seen largest.
  void add_instanced(const FrameGroup& group) {
    Box3d box;
    for (const FrameShape& shape : group.shapes)
      box.grow(image_of({shape.motion, nullptr, {}}, bounds_of(shape)));
    if (box.empty()) return;
    const double pixels_per_unit = measure(group, CoarseLevels(group.levels).from(0), box);
    const PixelSize pixel = PixelSize::uniform(1.0 / std::max(pixels_per_unit, kSmallest));
    const std::uint32_t prototype = translator_.begin_prototype(group.path, pixels_per_unit);
    for (const FrameShape& shape : group.shapes) {
      add_shape(shape, pixel,
                [&](const MeshInput& mesh) { translator_.add_prototype_mesh(prototype, mesh); });
    }
    place(group, prototype, box);
  }

  void place(const FrameGroup& group, std::uint32_t prototype, const Box3d& box) {
    const auto measured = [&](const std::vector<InstanceLevel>& levels, const Box3d& inner) {
      return measure(group, levels, inner);
    };
    const LevelParts found = sample_levels(group.levels, box, {measured, tolerance_});
    if (found.unusable > 0) {
      said_.push_back({Severity::kError, group.path, "xformOpOrder",
                       message("found ", found.unusable,
                               " matrices with an element that is not finite or larger than 2^60; expected "
                               "finite numbers; the instances there are left out")});
    }
    for (const SampledLevels& part : found.parts) {
      InstancesInput instances;
      instances.path = group.path;
      instances.prototype = prototype;
      instances.levels = part.levels;
      instances.visible = group.visible;
      instances.ids = part.instances;
      const Colors colors = colors_of(group, part.instances);
      instances.display_color = colors.primvar();
      translator_.add_instances(instances);
    }
  }

  double measure(const FrameGroup& group, const std::vector<InstanceLevel>& levels, const Box3d& box) const {
    if (box.empty()) return 0.0;
    InstancesInput instances;
    instances.path = group.path;
    instances.levels = levels;
    return translator_.pixels_per_unit(instances, box);
  }

  // Those of some instances.
  struct Colors {
    std::vector<Vec3f> at_frame{};
    std::vector<std::pair<double, std::vector<Vec3f>>> samples{};

    PrimvarInput<Vec3f> primvar() const {
      PrimvarInput<Vec3f> result;
      result.values = at_frame;
      for (const auto& [time01, values] : samples) result.samples.push_back({time01, values});
      return result;
    }
  };

  Colors colors_of(const FrameGroup& group, std::span<const std::int32_t> instances) {
    const PrimvarInput<Vec3f>& given = group.display_color;
    if (given.values.empty()) return {};
    if (given.values.size() != group.count()) {
      said_.push_back({Severity::kWarning, group.path, "primvars:displayColor",
                       message("found ", given.values.size(), " values, expected ", group.count(),
                               ", one an instance; ignored")});
      return {};
    }
    const auto taken = [&](std::span<const Vec3f> every) {
      std::vector<Vec3f> some;
      for (const std::int32_t instance : instances) some.push_back(every[std::size_t(instance)]);
      return some;
    };
    Colors colors{taken(given.values), {}};
    for (const PrimvarSample<Vec3f>& sample : given.samples) {
      if (sample.values.size() == given.values.size())
        colors.samples.emplace_back(sample.time01, taken(sample.values));
    }
    return colors;
  }

  void add_lights() {
    translator_.set_light_groups(input_.light_groups);
    const double frame01 = input_.shutter.clamped_frame01();
    std::size_t count = 0;
    for (const FrameLight& light : input_.lights) {
      const std::vector<double> times01 = light_times01(*light.motion, light.motion->held());
      for (std::uint32_t place = 0; place < light.motion->count(); ++place) {
        LightInput placed = placed_light(light.kind, light.light, *light.motion, place, times01, frame01);
        placed.light.name = light.path;
        static_cast<LightLook&>(placed.light) = light.look;
        if (light.offset) {
          for (Matrix4d& m : placed.world_from_light.matrices) m = product(*light.offset, m);
        }
        translator_.add_light(placed);
        ++count;
      }
    }
    if (count == 0 && input_.camera_light) translator_.add_light(camera_light(input_.camera));
  }

  static LightInput camera_light(const CameraInput& camera) {
    LightInput light;
    light.light.name = "camera light";
    light.light.kind = LightKind::kCamera;
    static_cast<LightValues&>(light.light) = {
        .angle_degrees = 0.0f, .radius = 0.0f, .width = 0.0f, .height = 0.0f};
    for (const CameraSample& sample : camera.samples) {
      light.world_from_light.times01.push_back(sample.time01);
      light.world_from_light.matrices.push_back(sample.world_from_camera);
    }
    return light;
  }

  AssembledFrame finished() {
    AssembledFrame frame;
    frame.diagnostics = std::move(said_);
    const auto add = [&](const std::vector<Diagnostic>& found) {
      frame.diagnostics.insert(frame.diagnostics.end(), found.begin(), found.end());
    };
    add(materials_.diagnostics());
    add(translator_.diagnostics());
    frame.tracks = translator_.tracks();
    frame.origin = translator_.origin();
    frame.empty = translator_.empty();
    frame.scene = translator_.finish();
    return frame;
  }

  const FrameInput& input_;
  double tolerance_;
  Translator translator_;
  BoundMaterials materials_;
  PixelSize pixel_;
  std::vector<Diagnostic> said_;
};

}  // namespace

std::size_t FrameGroup::count() const {
  std::size_t result = 1;
  for (const PlacedLevel& level : levels) result *= level.count();
  return result;
}

Box3d box_of(const MeshInput& mesh) {
  Box3d box;
  for (const ArraySample& sample : mesh.points.samples) {
    for (const Vec3f& point : sample.values) {
      if (is_finite(point)) box.grow(Vec3d(point));
    }
  }
  if (mesh.round.kind == RoundInput::Kind::kNone || box.empty()) return box;
  const double reach = 0.5 * largest_width(mesh.round.widths);
  return {box.lo - Vec3d{reach, reach, reach}, box.hi + Vec3d{reach, reach, reach}};
}

AssembledFrame assemble_frame(const FrameInput& input, const TranslatorSettings& settings,
                              const TextureSource& textures, std::shared_ptr<RefinementCache> refinements) {
  return Assembler(input, settings, textures, std::move(refinements)).assembled();
}

}  // namespace msbvh::translate
