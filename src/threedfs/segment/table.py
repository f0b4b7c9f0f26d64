"""How the support surface looks where no object covers it, from all keyframes together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit

from threedfs.read_ahead import map_ahead
from threedfs.segment.color_model import TableMatch, lab_image
from threedfs.segment.light import relight_table
from threedfs.types import Box, Plane, View

_LEAST_VIEWS = 3
"""Views that must show a spot uncovered: of two that differ, neither is known to be right."""
_NOISE = 3.0
"""Standard deviation of a channel of Lab between views of the same spot, at least: noise of a camera, resampling."""
_SPREAD = 0.9
"""Standard deviation of a channel per median distance in Lab; of a normal distribution it would be 0.65."""
_WIDEST = 10.0
"""Median distance in Lab above which the views do not show one surface at a spot."""
_AROUND = 13
"""Pixels of the picture by which what is beneath the object is enlarged, in all."""
_LONGEST = 900
"""Pixels along the longer side of the flat picture, so that memory does not grow with the images."""


@dataclass(frozen=True)
class TablePicture:
    """The support surface as a flat picture.

    Attributes
    ----------
    color : (H, W, 3) float32
        Lab, median over the views that show the spot.
    spread : (H, W) float32
        Median distance of their colours from it, Lab.
    known : (H, W) bool
    beneath : (H, W) bool
        Where the object stands on it.
    world_from_picture : (4, 3) float64
        Homogeneous world points of homogeneous pixels (u, v, 1).
    """

    color: np.ndarray
    spread: np.ndarray
    known: np.ndarray
    beneath: np.ndarray
    world_from_picture: np.ndarray

    def predict(self, view: View) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return colour (H, W, 3), spread, whether known, and what is beneath the object, by the pixels of a view."""
        image_from_picture = view.px_from_world @ self.world_from_picture
        size = (view.camera.width, view.camera.height)
        color, spread, known, beneath = (
            cv2.warpPerspective(array, image_from_picture, size, flags=cv2.INTER_LINEAR)
            for array in (self.color, self.spread, self.known.astype(np.float32), self.beneath.astype(np.float32))
        )
        return color, spread, known > 0.99, beneath > 0


def compare_table(
    picture: TablePicture, view: View, lab: np.ndarray, clear: np.ndarray, silhouette: np.ndarray, light_reach: float
) -> TableMatch:
    """Compare an image with the support surface as it would look in it, in the light of the image.

    Parameters
    ----------
    picture : TablePicture
    view : View
    lab : (H, W, 3) float32
    clear : (H, W) bool
        Pixels that do not show the object.
    silhouette : (H, W) bool
        About where the object is.
    light_reach : float
        Standard deviation of the neighbourhood over which the light is taken to be one, roots of the silhouette's area.
    """
    color, spread, known, beneath = picture.predict(view)
    reach = light_reach * np.sqrt(silhouette.sum())
    return match_table(lab, relight_table(lab, color, clear & known, reach), spread, known, beneath)


def match_table(
    lab: np.ndarray, color: np.ndarray, spread: np.ndarray, known: np.ndarray, beneath: np.ndarray
) -> TableMatch:
    """Compare an image with the support surface as it would look in it.

    The best match within a pixel around counts, as cameras are not exact to a pixel.

    Parameters
    ----------
    lab : (H, W, 3) float32
    color, spread, known, beneath
        As `TablePicture.predict` gives them.
    """
    deviation = np.sqrt(_NOISE**2 + (_SPREAD * spread) ** 2)
    best = _match_around(lab, color, known)
    density = -0.5 * best / deviation**2 - 3 * np.log(deviation) - 1.5 * np.log(2 * np.pi)
    return TableMatch(known, color, density.astype(np.float32), beneath)


@njit(nogil=True, cache=True)
def _match_around(lab, color, known):
    """Return the least squared distance (H, W) of each pixel's colour from those known within a pixel around it.

    Rows and columns go on from the other end, where nothing is known next to the border.
    """
    rows, columns = known.shape
    best = np.full((rows, columns), np.inf, np.float32)
    for row in range(rows):
        for column in range(columns):
            for down in (-1, 0, 1):
                for across in (-1, 0, 1):
                    y, x = (row - down) % rows, (column - across) % columns
                    if known[y, x]:
                        apart = np.float32(0)
                        for channel in range(3):
                            apart += (lab[row, column, channel] - color[y, x, channel]) ** 2
                        best[row, column] = min(best[row, column], apart)
    return best


def picture_table(
    images: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    covered: Mapping[str, np.ndarray],
    valid: Mapping[str, np.ndarray],
    plane: Plane,
    solid: np.ndarray,
    box: Box,
    threads: int = 1,
) -> TablePicture:
    """Take a picture of the support plane, seen from above, out of all views.

    Not in the paper. What lies flat on the table, shadows among it, looks the same in all views; the object does not.

    Parameters
    ----------
    images : mapping of str to (H, W, 3) uint8
        RGB.
    views : mapping of str to View
    covered : mapping of str to (H, W) bool
        Pixels that may show the object.
    valid : mapping of str to (H, W) bool
        Pixels that show the scene.
    plane : Plane
    solid : (N, 3) float64
        World points inside the object.
    box : Box
        Around what the picture is needed for, standing on the plane; the picture lies along its sides.
    threads : int
        Cores used; the result does not depend on it.
    """
    world_from_picture, size = _lay_out(plane, box, views)

    colors = np.empty((len(views), size[1], size[0], 3), np.float32)
    shown = np.empty(colors.shape[:3], bool)

    def lay_flat(rank: int, name: str) -> None:
        view = views[name]
        picture_from_image = np.linalg.inv(view.px_from_world @ world_from_picture)
        clear = (valid[name] & ~covered[name]).astype(np.float32)
        lab = lab_image(images[name])
        cv2.warpPerspective(lab, picture_from_image, size, dst=colors[rank], flags=cv2.INTER_LINEAR)
        shown[rank] = cv2.warpPerspective(clear, picture_from_image, size, flags=cv2.INTER_LINEAR) > 0.99
        shown[rank] &= _in_front(view, world_from_picture, size)

    for _ in map_ahead(lambda item: lay_flat(*item), enumerate(views), threads=threads):
        pass
    color, spread, known = _combine(colors, shown)
    known &= spread < _WIDEST
    return TablePicture(color, spread, known, _stand_on(world_from_picture, solid, known.shape), world_from_picture)


@njit(cache=True)
def _combine(colors, shown):
    """Return the median colour (H, W, 3) over the views that show each spot, the median distance, and whether known."""
    views, rows, columns = shown.shape
    color, spread = np.zeros((rows, columns, 3), np.float32), np.zeros((rows, columns), np.float32)
    known = np.zeros((rows, columns), np.bool_)
    values, own = np.empty(views, np.float32), np.empty(views, np.int64)
    for row in range(rows):
        for column in range(columns):
            count = 0
            for view in range(views):
                if shown[view, row, column]:
                    own[count] = view
                    count += 1
            if count < _LEAST_VIEWS:
                continue
            known[row, column] = True
            for channel in range(3):
                for place in range(count):
                    values[place] = colors[own[place], row, column, channel]
                color[row, column, channel] = _take_median(values, count)
            for place in range(count):
                total = np.float32(0)
                for channel in range(3):
                    total += (colors[own[place], row, column, channel] - color[row, column, channel]) ** 2
                values[place] = np.sqrt(total)
            spread[row, column] = _take_median(values, count)
    return color, spread, known


@njit(cache=True)
def _take_median(values, count):
    """Sort the first values in place, by insertion as they are few, and return their median."""
    for place in range(1, count):
        value, before = values[place], place - 1
        while before >= 0 and values[before] > value:
            values[before + 1] = values[before]
            before -= 1
        values[before + 1] = value
    return (values[(count - 1) // 2] + values[count // 2]) / np.float32(2)


def _stand_on(world_from_picture, solid, shape):
    """Mark where points inside the object lie straight above the picture, and a little around."""
    across, along, origin = world_from_picture[:3].T
    step = across @ across  # both axes have the length of a pixel, at right angles
    u, v = (np.rint((solid - origin) @ axis / step).astype(np.int64) for axis in (across, along))
    inside = (u >= 0) & (v >= 0) & (u < shape[1]) & (v < shape[0])
    beneath = np.zeros(shape, np.uint8)
    beneath[v[inside], u[inside]] = 1
    return cv2.dilate(beneath, np.ones((_AROUND, _AROUND), np.uint8)) > 0


def _lay_out(plane, box, views):
    """Return (4, 3) world from picture, and the picture's (width, height), for the part of the plane in a box."""
    across, along = box.axes[:2]
    spans = list(zip(box.low[:2].tolist(), box.high[:2].tolist(), strict=True))
    middle = box.centre - plane.distance(box.centre) * plane.normal
    nearest = min(float(np.linalg.norm(view.centre - middle)) for view in views.values())
    pixel = nearest / max(view.camera.fx for view in views.values())
    pixel = max(pixel, max(stop - start for start, stop in spans) / _LONGEST)
    size = tuple(int(np.ceil((stop - start) / pixel)) + 1 for start, stop in spans)
    origin = spans[0][0] * across + spans[1][0] * along - plane.offset * plane.normal
    return np.vstack([np.stack([pixel * across, pixel * along, origin], axis=1), [0, 0, 1]]), size


def _in_front(view, world_from_picture, size):
    """Say which pixels of the picture lie in front of a camera, (height, width) bool."""
    depth = view.cam_from_world[2] @ world_from_picture
    u, v = np.arange(size[0]), np.arange(size[1])
    return depth[0] * u + depth[1] * v[:, None] + depth[2] > 0
