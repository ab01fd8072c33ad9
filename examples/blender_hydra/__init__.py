"""MSBVH as a render engine of Blender, by Blender's own Hydra engine.

Blender finds the plugin where MSBVH_HYDRA_PLUGIN names its folder (PREFIX/plugin/usd/hdMsbvh), or on
PXR_PLUGINPATH_NAME. It has to be built for the OpenUSD that this Blender contains: `msbvh hydra-info --host` tells.
Blender hands each frame to Hydra as it stands at the frame, without motion over the shutter: pictures are sharp.
"""

import os

import bpy

PLUGIN = "HdMsbvhRendererPlugin"
PLUGIN_FOLDER = "MSBVH_HYDRA_PLUGIN"

INTERPOLATIONS = ("auto", "linear", "quadratic", "cubic")
BUILDERS = ("msbvh", "mbvh", "swept", "timesplit")


def items_of(names):
    """For an EnumProperty: each name stands for itself."""
    return [(name, name, "") for name in names]


class MsbvhSettings(bpy.types.PropertyGroup):
    """What a scene asks of the renderer; the standard values are the plugin's."""

    samples: bpy.props.IntProperty(name="Samples", description="Samples per pixel", default=64, min=1)
    viewport_samples: bpy.props.IntProperty(
        name="Viewport samples", description="Samples per pixel in the viewport", default=16, min=1
    )
    max_bounces: bpy.props.IntProperty(name="Bounces", default=2, min=0)
    seed: bpy.props.IntProperty(name="Seed", default=0, min=0)
    threads: bpy.props.IntProperty(name="Threads", description="0: all", default=0, min=0)
    motion_tolerance: bpy.props.FloatProperty(
        name="Motion tolerance",
        description="How far a moving point may be off its path, in pixels",
        default=0.1,
        min=1e-3,
    )
    edge_length: bpy.props.FloatProperty(
        name="Edge length", description="Edges of subdivided surfaces in pixels; 0: cages", default=1.0, min=0.0
    )
    interpolation: bpy.props.EnumProperty(name="Interpolation", items=items_of(INTERPOLATIONS), default="auto")
    builder: bpy.props.EnumProperty(name="Builder", items=items_of(BUILDERS), default="msbvh")


def render_settings(settings, engine_type):
    """Hydra's render settings by key; `engine_type` is FINAL or VIEWPORT."""
    values = {
        "convergedSamplesPerPixel": settings.viewport_samples if engine_type == "VIEWPORT" else settings.samples,
        "threadLimit": settings.threads,
        "msbvh:maxBounces": settings.max_bounces,
        "msbvh:seed": settings.seed,
        "msbvh:motionTolerance": settings.motion_tolerance,
        "msbvh:edgeLength": settings.edge_length,
        "msbvh:interpolation": settings.interpolation,
        "msbvh:builder": settings.builder,
    }
    if engine_type != "VIEWPORT":
        values |= {"aovToken:Combined": "color", "aovToken:Depth": "cameraDepth", "aovToken:Normal": "normal"}
    return values


class MsbvhRenderEngine(bpy.types.HydraRenderEngine):
    """Blender exports the scene and shows the picture; both are HydraRenderEngine's own work."""

    bl_idname = "MSBVH"
    bl_label = "MSBVH"
    bl_info = "Motion-blurred frames on the CPU"
    bl_use_preview = True
    bl_use_gpu_context = False
    bl_use_materialx = False
    bl_delegate_id = PLUGIN

    @classmethod
    def register(cls):
        """Tells OpenUSD where the plugin is."""
        bpy.utils.expose_bundled_modules()
        from pxr import Plug  # after Blender has shown its own OpenUSD

        folder = os.environ.get(PLUGIN_FOLDER)
        if folder:
            Plug.Registry().RegisterPlugins([folder])

    def get_render_settings(self, engine_type):
        """Called by Blender before each render."""
        return render_settings(bpy.context.scene.msbvh, engine_type)

    def update_render_passes(self, scene, render_layer):
        """The passes that a compositor can use."""
        if render_layer.use_pass_combined:
            self.register_pass(scene, render_layer, "Combined", 4, "RGBA", "COLOR")
        if render_layer.use_pass_z:
            self.register_pass(scene, render_layer, "Depth", 1, "Z", "VALUE")
        if render_layer.use_pass_normal:
            self.register_pass(scene, render_layer, "Normal", 3, "XYZ", "VECTOR")


class MsbvhPanel(bpy.types.Panel):
    """The render tab of the properties editor."""

    bl_idname = "RENDER_PT_msbvh"
    bl_label = "MSBVH"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = frozenset({MsbvhRenderEngine.bl_idname})

    @classmethod
    def poll(cls, context):
        """Shown where MSBVH is the engine."""
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        """One line a setting."""
        self.layout.use_property_split = True
        for name in MsbvhSettings.__annotations__:
            self.layout.prop(context.scene.msbvh, name)


CLASSES = (MsbvhSettings, MsbvhRenderEngine, MsbvhPanel)


def register():
    """Called by Blender when the add-on is switched on."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.msbvh = bpy.props.PointerProperty(type=MsbvhSettings)


def unregister():
    """Called by Blender when the add-on is switched off."""
    del bpy.types.Scene.msbvh
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
