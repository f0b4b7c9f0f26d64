"""The data that pass between topics: frozen dataclasses of arrays.

Conventions (docs/conventions.md): right-handed; camera x right, y down, z forward; pixel (u, v) =
(column, row) with integer coordinates at pixel centres; depth is camera-frame z; missing is NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion, in pixels; integer coordinates are pixel centres."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def px_from_cam(self) -> np.ndarray:
        """(3, 3) float64 intrinsic matrix."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], dtype=np.float64)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of its images."""
        return (self.height, self.width)


@dataclass(frozen=True)
class View:
    """A posed image: its frame name, camera, and rigid (4, 4) float64 `cam_from_world`."""

    name: str
    camera: Camera
    cam_from_world: np.ndarray

    @property
    def centre(self) -> np.ndarray:
        """(3,) camera centre in world coordinates, scene units."""
        return -self.cam_from_world[:3, :3].T @ self.cam_from_world[:3, 3]

    @property
    def px_from_world(self) -> np.ndarray:
        """(3, 4) projection matrix to homogeneous pixels; its third row gives depth."""
        return self.camera.px_from_cam @ self.cam_from_world[:3]


@dataclass(frozen=True)
class Keyframe:
    """A view for which depth is computed.

    Attributes
    ----------
    view : View
    neighbours : tuple of View
        The frames it is matched against, best first.
    near, far : float
        Expected depth range, scene units.
    within : tuple of float, optional
        Nearest and farthest depth of the object's box, scene units, where that is known.
    """

    view: View
    neighbours: tuple[View, ...]
    near: float
    far: float
    within: tuple[float, float] | None = None

    @property
    def neighbour_angle(self) -> float:
        """Median angle in degrees between the rays to its camera and to a neighbour's; 0 without neighbours.

        Rays meet on the optical axis, at the harmonic mean of near and far.
        """
        if not self.neighbours:
            return 0.0
        target = self.view.centre + 2 / (1 / self.near + 1 / self.far) * self.view.cam_from_world[2, :3]
        rays = np.stack([view.centre - target for view in (self.view, *self.neighbours)])
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        return float(np.median(np.degrees(np.arccos(np.clip(rays[1:] @ rays[0], -1, 1)))))


@dataclass(frozen=True)
class Features:
    """Keypoints of one frame.

    Attributes
    ----------
    pixels : (N, 2) float64
        Where they are in the raw frame, integer pixel centres.
    descriptors : (N, 128) uint8
        SIFT descriptors, root-normalised to length 512.
    colors : (N, 3) uint8
        RGB at the keypoints.
    """

    pixels: np.ndarray
    descriptors: np.ndarray
    colors: np.ndarray


@dataclass(frozen=True)
class SparsePoints:
    """Triangulated scene points with visibility.

    Attributes
    ----------
    xyz : (N, 3) float64, world, scene units
    rgb : (N, 3) uint8
    error : (N,) float64, mean reprojection error in pixels
    track_point : (M,) int64, index into xyz of each observation, ascending
    track_frame : (M,) int64, index of the frame (in the order of poses.json) that sees it
    """

    xyz: np.ndarray
    rgb: np.ndarray
    error: np.ndarray
    track_point: np.ndarray
    track_frame: np.ndarray

    def seen_by(self, frame: int) -> np.ndarray:
        """Indices of the points that frame number `frame` sees."""
        return self.track_point[self.track_frame == frame]


@dataclass(frozen=True)
class OrientedPoints:
    """Points on surfaces, with the surface's direction and visibility.

    Attributes
    ----------
    xyz : (N, 3) float32, world, scene units
    normal : (N, 3) float32, world, of length 1, out of the surface
    rgb : (N, 3) uint8
    seen_point : (M,) int64, index into xyz of each sighting, ascending
    seen_view : (M,) int64, rank of the keyframe that sees it
    """

    xyz: np.ndarray
    normal: np.ndarray
    rgb: np.ndarray
    seen_point: np.ndarray
    seen_view: np.ndarray

    @property
    def sightings(self) -> np.ndarray:
        """(N,) int64, by how many keyframes each point is seen."""
        return np.bincount(self.seen_point, minlength=len(self.xyz))

    def take(self, kept: np.ndarray) -> OrientedPoints:
        """Return those of the points, with their sightings, for which `kept` (N,) bool is true."""
        renumbered = np.cumsum(kept) - 1
        seen = kept[self.seen_point]
        return OrientedPoints(
            self.xyz[kept],
            self.normal[kept],
            self.rgb[kept],
            renumbered[self.seen_point[seen]],
            self.seen_view[seen],
        )


@dataclass(frozen=True)
class Box:
    """A box of the world: the points x with low <= axes @ x <= high.

    Attributes
    ----------
    axes : (3, 3) float64
        Rows are the world directions of its sides, orthonormal, right-handed.
    low, high : (3,) float64
        Coordinates of its faces along its axes, scene units.
    """

    axes: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def centre(self) -> np.ndarray:
        """(3,) float64, world."""
        return (self.low + self.high) / 2 @ self.axes

    @property
    def longest(self) -> float:
        """Length of its longest side, scene units."""
        return float((self.high - self.low).max())

    def grow(self, reach: float) -> Box:
        """Return the box that reaches farther to every side, scene units."""
        return Box(self.axes, self.low - reach, self.high + reach)

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Say which world points (..., 3) lie in it, faces included; NaN is outside."""
        along = points @ self.axes.T
        return ((along >= self.low) & (along <= self.high)).all(axis=-1)

    def corners(self) -> np.ndarray:
        """Return its eight corners (8, 3), world."""
        return np.array([np.where([i & 1, i & 2, i & 4], self.high, self.low) for i in range(8)]) @ self.axes


@dataclass(frozen=True)
class VoxelGrid:
    """A regular grid. Volumes on it are indexed [ix, iy, iz] with values at voxel centres.

    Attributes
    ----------
    origin : (3,) float64
        Centre of voxel (0, 0, 0), world.
    spacing : float
        Edge of a voxel, scene units.
    shape : (int, int, int)
        (nx, ny, nz)
    axes : (3, 3) float64
        Rows are the world directions of its axes, orthonormal, right-handed.
    """

    origin: np.ndarray
    spacing: float
    shape: tuple[int, int, int]
    axes: np.ndarray = field(default_factory=lambda: np.eye(3))

    @property
    def world_from_voxel(self) -> np.ndarray:
        """(4, 4) float64, from homogeneous voxel indices to the world."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.spacing * self.axes.T, self.origin
        return matrix

    def axis(self, dimension: int) -> np.ndarray:
        """Coordinates of the voxel centres along one of its axes, (shape[dimension],) float64: axes[dimension] @ x."""
        return self.axes[dimension] @ self.origin + self.spacing * np.arange(self.shape[dimension])


@dataclass(frozen=True)
class Plane:
    """Points x with normal . x + offset = 0; the signed distance is positive on the side of the cameras."""

    normal: np.ndarray
    offset: float

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Signed distance of points (..., 3), scene units."""
        return points @ self.normal + self.offset


@dataclass(frozen=True)
class Support:
    """Where the object stands.

    Attributes
    ----------
    plane : Plane
        The support surface; its positive side holds the object and the cameras.
    box : Box
        Around the object, standing on the plane: its third axis is the plane's normal.
    figures : mapping of str to float
        What the search for them found (inlier share, ...).
    """

    plane: Plane
    box: Box
    figures: Mapping[str, float]


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh: vertices (V, 3) float64 world; faces (F, 3) int64, counter-clockwise from outside."""

    vertices: np.ndarray
    faces: np.ndarray
