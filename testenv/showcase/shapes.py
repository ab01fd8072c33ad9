"""Meshes of the showcase: points, faces and, where a texture needs them, coordinates.

Arrays are float64[n, 3] of points and float64[corners, 2] of coordinates, one a corner of a face, in the faces' order.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray
Faces = list[tuple[int, ...]]


def grid_faces(rows: int, columns: int) -> Faces:
    return [
        (r * columns + c, r * columns + c + 1, (r + 1) * columns + c + 1, (r + 1) * columns + c)
        for r in range(rows - 1)
        for c in range(columns - 1)
    ]


def torus(major: float, minor: float, around: int, across: int) -> tuple[Array, Faces]:
    """About the z axis."""
    a, b = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    radius = major + minor * np.cos(b)
    points = np.stack([radius * np.cos(a), radius * np.sin(a), minor * np.sin(b)], axis=-1).reshape(-1, 3)
    faces = [
        (
            i * across + j,
            (i + 1) % around * across + j,
            (i + 1) % around * across + (j + 1) % across,
            i * across + (j + 1) % across,
        )
        for i in range(around)
        for j in range(across)
    ]
    return points, faces


def sphere(radius: float, around: int, rows: int) -> tuple[Array, Faces]:
    """About the y axis, rings from the south pole up."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)[1:-1, None]
    longitude = (np.arange(around) * 2 * np.pi / around)[None, :]
    ring = np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.sin(latitude) + 0 * longitude,
            np.cos(latitude) * np.sin(longitude),
        ],
        axis=-1,
    ).reshape(-1, 3)
    points = radius * np.concatenate([[(0.0, -1.0, 0.0)], ring, [(0.0, 1.0, 0.0)]])
    top = len(points) - 1
    faces: Faces = []
    for i in range(around):
        j = (i + 1) % around
        faces.append((0, 1 + i, 1 + j))
        faces.append((top, top - around + j, top - around + i))
        for r in range(rows - 2):
            low = 1 + r * around
            faces.append((low + i, low + around + i, low + around + j, low + j))
    return points, faces


def sphere_st(points: Array, faces: Faces) -> Array:
    """Longitude and height of a sphere about the y axis; whole across the seam, and straight to the poles."""
    at = points / np.linalg.norm(points, axis=1, keepdims=True)
    turn = np.arctan2(at[:, 2], at[:, 0]) / (2 * np.pi)
    found = []
    for face in faces:
        u = turn[list(face)]
        poles = np.abs(at[list(face), 1]) > 1 - 1e-9
        first = u[~poles][0]
        u = first + (u - first + 0.5) % 1.0 - 0.5
        u[poles] = u[~poles].mean()
        found.append(np.stack([u, 0.5 + np.arcsin(np.clip(at[list(face), 1], -1, 1)) / np.pi], axis=-1))
    return np.concatenate(found)


def tube(start: tuple[float, ...], end: tuple[float, ...], radius: float, around: int) -> tuple[Array, Faces]:
    """A closed cylinder between two points; its caps have vertices of their own, so that the edges stay
    sharp."""
    axis = np.subtract(end, start) / np.linalg.norm(np.subtract(end, start))
    side = np.cross(axis, (0.0, 1.0, 0.0) if abs(axis[1]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    angle = (np.arange(around) * 2 * np.pi / around)[:, None]
    ring = radius * (np.cos(angle) * side + np.sin(angle) * np.cross(axis, side))
    points = np.concatenate([ring + start, ring + end] * 2)
    faces: Faces = [tuple(range(2 * around, 3 * around))[::-1], tuple(range(3 * around, 4 * around))]
    faces += [(i, (i + 1) % around, around + (i + 1) % around, around + i) for i in range(around)]
    return points, faces


def cube(half: float) -> tuple[Array, Faces]:
    """Its faces share no vertices, so that the edges stay sharp."""
    corners = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners[np.ravel(sides)], [(i, i + 1, i + 2, i + 3) for i in range(0, 24, 4)]


def die_st() -> Array:
    """Of cube(): a sixth of the texture's width for each face, opposite faces 7 together."""
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    return np.concatenate([(square + (number - 1, 0)) / (6, 1) for number in (1, 6, 2, 5, 3, 4)])


def smooth_normals(points: Array, faces: Faces) -> Array:
    """Unit vertex normals, weighted by area; float64[n, 3]."""
    normals = np.zeros_like(points)
    for face in faces:
        corners = points[list(face)]
        normals[list(face)] += np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
