"""msbvh: motion-blurred frames from USD on the CPU, by the MSBVH.

The command line is `msbvh` (msbvh.cli.main). From Python:

    from msbvh.render.record import RecordSettings, record
    record("shot.usda", ["shot.exr"], RecordSettings(spp=64))
"""
