"""msbvh: motion-blurred frames from USD on the CPU, by the MSBVH.

The command line is `msbvh` (msbvh.cli). From Python:

    from msbvh.record import RecordSettings, record
    record("shot.usda", ["shot.exr"], RecordSettings(spp=64))
"""
