"""Renders the public scenes beside the checkout to one contact sheet: `make gallery`.

    python docs/make_gallery.py [--scenes FOLDER] [--out FOLDER] [--only GLOB]... [--again] [--width PIXELS] [--spp N]

The folder of scenes has an INDEX.tsv with the columns group, name, root, frame and open. Each scene is rendered by
`msbvh record` to OUT/GROUP-NAME-ROOT.png; those that are there already are kept. OUT/gallery.png shows all of them with their
names, beside the reference picture that lies with a scene. What cannot be drawn says why, on the sheet and at the end. Exit
code 1 where such a scene is one that the index says opens.
"""

from __future__ import annotations

import argparse
import csv
import fnmatch
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[1]
PICTURES = (".png", ".jpg", ".jpeg", ".exr", ".tif", ".tiff")
REFERENCE_FOLDERS = ("baseline", "screenshots", "reference", "baselines", "ref")
COLUMNS, LABEL = 6, 18
TIMEOUT_SECONDS = 900.0


@dataclass(frozen=True)
class Scene:
    """A line of the index."""

    name: str
    root: Path
    frame: str
    """Time code; empty: the stage's start."""
    opens: bool
    """Whether its file can be opened at all; some are broken on purpose."""
    reference: Path | None


@dataclass(frozen=True)
class Tile:
    """A place on the sheet."""

    label: str
    picture: Path | None
    """None: nothing was drawn."""
    said: str = ""
    """Why."""


def main() -> int:
    options = _parser().parse_args()
    scenes = [scene for scene in _scenes(options.scenes) if _wanted(scene, options.only)]
    if not scenes:
        print(f"gallery: error: {options.scenes}: found no scene; expected some in INDEX.tsv", file=sys.stderr)
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    tiles, missing = [], []
    for number, scene in enumerate(scenes, 1):
        tile = _drawn(scene, options)
        print(f"gallery: [{number}/{len(scenes)}] {scene.name}{': ' + tile.said if tile.said else ''}", flush=True)
        if tile.picture is None and scene.opens:
            missing.append(scene.name)
        tiles.append(tile)
        if scene.reference is not None:
            tiles.append(Tile("reference", scene.reference))
    sheet = options.out / "gallery.png"
    _write_sheet(tiles, sheet, options.width)
    print(f"gallery: wrote {sheet}: {len(scenes)} scenes, {len(missing)} not drawn")
    return 1 if missing else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Renders public scenes to one contact sheet.")
    parser.add_argument("--scenes", type=Path, default=ROOT.parent / "shared" / "scenes", metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "gallery", metavar="FOLDER")
    parser.add_argument("--only", action="append", default=[], metavar="GLOB", help="only scenes of such names")
    parser.add_argument("--again", action="store_true", help="render also what is there")
    parser.add_argument("--width", type=int, default=320, metavar="PIXELS", help="of a picture; default: 320")
    parser.add_argument("--spp", type=int, default=16, metavar="N", help="samples a pixel; default: 16")
    return parser


def _wanted(scene: Scene, globs: Sequence[str]) -> bool:
    return not globs or any(fnmatch.fnmatch(scene.name, glob) for glob in globs)


def _scenes(folder: Path) -> list[Scene]:
    index = folder / "INDEX.tsv"
    if not index.is_file():
        return []
    with index.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines, delimiter="\t"))
    return [_scene(folder / row["group"] / row["name"], row) for row in rows]


def _scene(folder: Path, row: dict[str, str]) -> Scene:
    root = folder / row["root"]
    frame = "" if row["frame"] in ("", "None") else row["frame"]
    name = f"{row['group']}-{row['name']}-{root.stem}"
    return Scene(name, root, frame, row["open"] == "ok", _reference(folder, root.stem))


def _reference(folder: Path, stem: str) -> Path | None:
    """The picture of that name in a folder of references, else the only one that lies there, else the only one whose name
    ends so, or whose last word is how the scene's name begins or ends."""
    found = [
        path
        for each in REFERENCE_FOLDERS
        for path in sorted((folder / each).rglob("*"))
        if path.suffix.lower() in PICTURES
    ]
    named = [path for path in found if path.stem == stem]
    ending = [path for path in found if path.stem.endswith(f"_{stem}")]
    words = [(path, path.stem.rpartition("_")[2].lower()) for path in found]
    alike = [
        path for path, word in words if len(word) > 4 and (stem.lower().startswith(word) or stem.lower().endswith(word))
    ]
    if named:
        return named[0]
    return next((each[0] for each in (ending, alike, found) if len(each) == 1), None)


def _drawn(scene: Scene, options: argparse.Namespace) -> Tile:
    picture = options.out / f"{scene.name}.png"
    if picture.is_file() and not options.again:
        return Tile(scene.name, picture)
    command = [
        sys.executable,
        "-m",
        "msbvh",
        "record",
        scene.root,
        picture,
        "-w",
        str(options.width),
        "--spp",
        str(options.spp),
    ]
    if scene.frame:
        command += ["--frames", scene.frame]
    try:
        done = subprocess.run(
            list(map(str, command)),
            capture_output=True,
            text=True,
            timeout=TIMEOUT_SECONDS,
            env={**os.environ, "COLUMNS": "200"},
        )
    except subprocess.TimeoutExpired:
        return Tile(scene.name, None, f"took more than {TIMEOUT_SECONDS:.0f} s")
    if done.returncode == 0 and picture.is_file():
        return Tile(scene.name, picture)
    lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
    return Tile(scene.name, None, lines[-1])


def _write_sheet(tiles: Sequence[Tile], out: Path, width: int) -> None:
    small = [(tile, _shrunk(tile.picture, width) if tile.picture else None) for tile in tiles]
    height = LABEL + max((picture.spec().height for _, picture in small if picture), default=width * 9 // 16)
    rows = (len(small) + COLUMNS - 1) // COLUMNS
    sheet = oiio.ImageBuf(oiio.ImageSpec(width * COLUMNS, height * rows, 3, "uint8"))
    for i, (tile, picture) in enumerate(small):
        x, y = i % COLUMNS * width, i // COLUMNS * height
        if picture:
            oiio.ImageBufAlgo.paste(sheet, x, y + LABEL, 0, 0, picture)
        oiio.ImageBufAlgo.render_text(
            sheet, x + 4, y + LABEL - 5, tile.label[: width // 7], 12, textcolor=(1.0, 1.0, 1.0)
        )
        if tile.said:
            oiio.ImageBufAlgo.render_text(
                sheet, x + 4, y + 2 * LABEL, tile.said[: width // 6], 11, textcolor=(1.0, 0.6, 0.5)
            )
    part = out.with_suffix(".part.png")
    if not sheet.write(str(part)):
        raise SystemExit(f"gallery: error: {out}: {sheet.geterror()}")
    part.replace(out)


def _shrunk(path: Path, width: int) -> oiio.ImageBuf | None:
    """Three channels of 8 bits, `width` wide, at most as high; None where it cannot be read."""
    picture = oiio.ImageBuf(str(path))
    if picture.has_error or picture.spec().width < 1:
        return None
    spec = picture.spec()
    channels = (0, 1, 2) if spec.nchannels >= 3 else (0, 0, 0)
    picture = oiio.ImageBufAlgo.channels(picture, channels)
    if path.suffix.lower() == ".exr":
        picture = oiio.ImageBufAlgo.colorconvert(
            picture, "lin_rec709_scene", "srgb_rec709_scene", colorconfig="ocio://default"
        )
    height = max(1, min(width, round(spec.height * width / spec.width)))
    return oiio.ImageBufAlgo.resize(picture, roi=oiio.ROI(0, width, 0, height, 0, 1, 0, 3))


if __name__ == "__main__":
    sys.exit(main())
