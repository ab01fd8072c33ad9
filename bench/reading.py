"""How long reading many small meshes takes, beside an older build where one is given: microseconds a mesh.

    .venv/bin/python bench/reading.py [--count N] [--rounds R] [--old PYTHON]

PYTHON is the interpreter of the older build's environment. A round reads each stage once with either, in a process of
its own; ratios are new over old, round by round: median [least, most]. Prints a Markdown table.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import click
from pxr import Gf, Usd, UsdGeom, Vt

MOTIONS = ("still", "moving", "turning")
STEPS = ("traverse", "meshes")

READ = """
import json, sys
from pxr import Usd
try:
    from msbvh.scene.reader import ReadSettings, read_frame
except ImportError:  # Before there were subpackages.
    from msbvh.reader import ReadSettings, read_frame
print(json.dumps(read_frame(Usd.Stage.Open(sys.argv[1]), 1.0, ReadSettings()).seconds))
"""


def write_stage(file: Path, count: int, motion: str) -> None:
    """Quads on a lattice, a hundred to a parent; moving ones have two samples of a translation, turning ones of a
    rotation as well."""
    stage = Usd.Stage.CreateNew(str(file))
    camera = UsdGeom.Camera.Define(stage, "/camera")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 1000))
    camera.CreateShutterOpenAttr(-0.25)
    camera.CreateShutterCloseAttr(0.25)
    points, quad = Vt.Vec3fArray([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]), Vt.IntArray([0, 1, 2, 3])
    for number in range(count):
        mesh = UsdGeom.Mesh.Define(stage, f"/set/group{number // 100}/mesh{number}")
        mesh.CreatePointsAttr(points)
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray([4]))
        mesh.CreateFaceVertexIndicesAttr(quad)
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateDisplayColorAttr([(0.2 + 0.6 * number / count, 0.5, 0.5)])
        place = Gf.Vec3d(number % 300 - 150, number // 300 - 150, 0)
        translate = mesh.AddTranslateOp()
        if motion == "still":
            translate.Set(place)
            continue
        translate.Set(place, 0)
        translate.Set(place + Gf.Vec3d(1, 0.5, 0), 2)
        if motion == "turning":
            rotate = mesh.AddRotateZOp()
            rotate.Set(0.0, 0)
            rotate.Set(90.0, 2)
    stage.Save()


def seconds(python: str, file: Path) -> dict[str, float]:
    done = subprocess.run([python, "-c", READ, str(file)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def spread(values: list[float], form: str) -> str:
    return f"{statistics.median(values):{form}} [{min(values):{form}}, {max(values):{form}}]"


@click.command()
@click.option("--count", default=20_000, show_default=True, type=click.IntRange(1))
@click.option("--rounds", default=5, show_default=True, type=click.IntRange(1))
@click.option("--old", type=click.Path(exists=True, dir_okay=False))
def main(count: int, rounds: int, old: str | None) -> None:
    columns = ["meshes", *(f"{step}, us a mesh" for step in STEPS), *(["new / old"] if old else [])]
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")
    with tempfile.TemporaryDirectory() as folder:
        for motion in MOTIONS:
            file = Path(folder) / f"{motion}.usdc"
            write_stage(file, count, motion)
            new, ratios = [], []
            for _ in range(rounds):
                new.append(seconds(sys.executable, file))
                if old:
                    before = seconds(old, file)
                    ratios.append(sum(new[-1][step] for step in STEPS) / sum(before[step] for step in STEPS))
            row = [motion, *(spread([1e6 * each[step] / count for each in new], ".1f") for step in STEPS)]
            print("| " + " | ".join([*row, *([spread(ratios, ".2f")] if old else [])]) + " |")


if __name__ == "__main__":
    main()
