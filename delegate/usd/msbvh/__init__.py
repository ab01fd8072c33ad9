"""msbvh: motion-blurred frames from USD on the CPU, by the MSBVH.

The command line is `msbvh` (msbvh.cli.main). From Python:

    from msbvh.render.record import record
    from msbvh.render.settings import RecordSettings, RenderSettings
    record("shot.usda", ["shot.exr"], RecordSettings(render=RenderSettings(spp=64)))
"""
