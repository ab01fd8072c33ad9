"""Pictures through the plugin beside those of `msbvh record`: same scene, seed, samples and settings.

    python tests/hydra/compare.py DRAW --plugins PATH [--engine indices|delegate|recorder] [--scenes GLOB] [--out DIR]
                                  [--known FILE]

DRAW is hydra_draw, PATH its PXR_PLUGINPATH_NAME (this process has an OpenUSD of its own, which is not to read it); the
scenes are those of testenv and of ../shared/scenes that have a camera. A picture may differ from that of `record` in alpha
by 0.001 in the mean, and in colour by half as much again as two seeds of `record` do. FILE has a line `SCENE: reason` for
each that the host hands over otherwise (docs/hydra.md). Exit code 1 if another one differs.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from pxr import Usd, UsdGeom

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared" / "scenes"
WIDTH = 160
SAMPLES = 64
ALPHA_BOUND = 1e-3
NOISE_BOUND = 1.5
SMALLEST_NOISE = 2e-3
TIMEOUT_SECONDS = 300


@dataclass(frozen=True)
class Shot:
    """What is drawn: the first camera of a scene, at one frame."""

    name: str
    scene: Path
    camera: str
    frame: float


@dataclass(frozen=True)
class Difference:
    """Mean absolute errors; `noise` is that of two seeds of `record`, in colour."""

    alpha: float
    colour: float
    noise: float

    @property
    def passed(self) -> bool:
        """Whether the two are the same picture."""
        return self.alpha <= ALPHA_BOUND and self.colour <= NOISE_BOUND * max(self.noise, SMALLEST_NOISE)


def shots(pattern: str) -> Iterator[Shot]:
    """Those with a camera whose scene opens."""
    roots = [("showcase", ROOT / "testenv" / "showcase" / "showcase.usda", "12")]
    if (SHARED / "INDEX.tsv").is_file():
        for line in (SHARED / "INDEX.tsv").read_text(encoding="utf-8").splitlines()[1:]:
            group, name, root, _, _, _, frame, *_ = line.split("\t")
            roots.append((f"{group}/{name}/{Path(root).stem}", SHARED / group / name / root, frame))
    for name, scene, frame in roots:
        if not fnmatch.fnmatch(name, pattern) or not scene.is_file():
            continue
        try:
            stage = Usd.Stage.Open(str(scene), Usd.Stage.LoadAll)
        except Exception as error:  # the scene's own fault: `record` has tests of it
            print(f"{name}: left out: {str(error).splitlines()[0][:80]}", file=sys.stderr)
            continue
        cameras = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera)]
        if cameras:
            start = stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else 0.0
            yield Shot(name, scene, str(cameras[0].GetPath()), float(frame) if frame not in ("", "None") else start)


def record(shot: Shot, out: Path, seed: int) -> np.ndarray:
    """RGBA by `msbvh record`."""
    command = [sys.executable, "-m", "msbvh", "record", "--camera", shot.camera, "--frames", f"{shot.frame:g}"]
    command += [
        "--imageWidth",
        str(WIDTH),
        "--spp",
        str(SAMPLES),
        "--seed",
        str(seed),
        "-rs",
        "",
        "--disableCameraLight",
    ]
    return _run([*command, str(shot.scene), str(out)], out, {})


@dataclass(frozen=True)
class Host:
    """hydra_draw, and how it is run."""

    program: Path
    plugins: str
    engine: str


def draw(shot: Shot, host: Host, size: tuple[int, int], out: Path) -> np.ndarray:
    """RGBA through the plugin."""
    command = [str(host.program), "--engine", host.engine, "--camera", shot.camera, "--frames", f"{shot.frame:g}"]
    command += ["--imageWidth", str(size[0]), "--imageHeight", str(size[1])]
    command += ["--set", f"convergedSamplesPerPixel={SAMPLES}"]
    command += ["--set", "domeLightCameraVisibility=0"]  # as usdrecord has it
    return _run([*command, str(shot.scene), str(out)], out, {"PXR_PLUGINPATH_NAME": host.plugins})


def _run(command: list[str], out: Path, more: dict[str, str]) -> np.ndarray:
    out.unlink(missing_ok=True)
    environment = {**os.environ, **more}
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=TIMEOUT_SECONDS, check=False, env=environment
    )
    if not out.is_file():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise RuntimeError(f"exit code {done.returncode}: {last[:200]}")
    return oiio.ImageBuf(str(out)).get_pixels()[..., :4]


def difference(shot: Shot, host: Host, folder: Path) -> Difference:
    """Draws it three times."""
    safe = shot.name.replace("/", "_")
    ours = record(shot, folder / f"{safe}.record.exr", 0)
    other = record(shot, folder / f"{safe}.seed1.exr", 1)
    theirs = draw(shot, host, (ours.shape[1], ours.shape[0]), folder / f"{safe}.{host.engine}.exr")
    if theirs.shape != ours.shape:
        raise RuntimeError(f"found a picture of {theirs.shape[1::-1]} pixels; record makes {ours.shape[1::-1]}")
    colour = np.abs(theirs - ours)[..., :3].mean()
    noise = np.abs(other - ours)[..., :3].mean()
    return Difference(float(np.abs(theirs - ours)[..., 3].mean()), float(colour), float(noise))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("draw", type=Path)
    parser.add_argument("--plugins", required=True)
    parser.add_argument("--engine", default="indices")
    parser.add_argument("--scenes", default="*")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--known", type=Path)
    options = parser.parse_args()
    known: dict[str, str] = {}
    if options.known:
        for line in options.known.read_text(encoding="utf-8").splitlines():
            scene, _, reason = line.partition(": ")
            known[scene] = reason
    failed = 0
    host = Host(options.draw, options.plugins, options.engine)
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.out or Path(scratch)
        os.makedirs(folder, exist_ok=True)
        for shot in shots(options.scenes):
            try:
                found = difference(shot, host, folder)
                passed = found.passed
                figures = f"alpha {found.alpha:.5f} colour {found.colour:.5f} noise {found.noise:.5f}"
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                passed, figures = False, str(error)
            reason = known.get(shot.name)
            failed += not passed and reason is None
            print("pass" if passed else f"known: {reason}:" if reason else "FAIL", shot.name, figures, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
