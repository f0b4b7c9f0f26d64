"""Small patches of one frame followed into others: where a point is seen, to a tenth of a pixel.

A patch is compared with the other image as an affine map of the predicted shape draws it; place and shape are
then refined by the inverse compositional method (Baker and Matthews, 2004), brightness and contrast taken out.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numba import njit

_ITERATIONS = 10
_SHIFTS = 2  # first iterations, which move the patch without changing its shape
_STEP = 0.01  # pixels; a smaller one ends the search
_CORNER = 4.0  # least mean square gradient of a patch in its flattest direction, (grey level / pixel)^2
_STIFFNESS = 8.0  # against changes of shape, in units of the same


@dataclass(frozen=True)
class Patches:
    """Patches and the frames to find them in; neighbouring entries of the same patch are made ready once.

    Attributes
    ----------
    source, target : (M,) int64
        Index of the image that the patch is cut from, and of that in which it is looked for.
    centre : (M, 2) float64
        Middle of the patch in the source image, pixels.
    expected : (M, 2) float64
        Where it should be in the target image, pixels.
    shape : (M, 2, 2) float64
        How offsets in the source image are mapped to the target image there.
    """

    source: np.ndarray
    target: np.ndarray
    centre: np.ndarray
    expected: np.ndarray
    shape: np.ndarray


def follow_patches(
    images: np.ndarray, patches: Patches, *, radius: int, max_shift: float, threads: int
) -> tuple[np.ndarray, np.ndarray]:
    """Find each patch in its target image.

    Parameters
    ----------
    images : (F, H, W) uint8
        Grey.
    patches : Patches
    radius : int
        Of the square patch, pixels.
    max_shift : float
        Farthest from the expected place, pixels along each axis.
    threads : int
        Changes no result.

    Returns
    -------
    pixels : (M, 2) float64
        Where it was found.
    correlation : (M,) float64
        Normalised, of the patch with what is there; -1 if it was not found.
    """
    count = len(patches.source)
    pixels, correlation = patches.expected.copy(), np.full(count, -1.0)
    bounds = np.linspace(0, count, 4 * threads + 1).astype(int)

    def follow(part: int) -> None:
        some = slice(bounds[part], bounds[part + 1])
        _follow(
            images,
            patches.source[some],
            patches.target[some],
            patches.centre[some],
            patches.expected[some],
            patches.shape[some],
            radius,
            max_shift,
            pixels[some],
            correlation[some],
        )

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(follow, range(4 * threads)))
    return pixels, correlation


@njit(nogil=True, cache=True)
def _follow(images, source, target, centre, expected, shape, radius, max_shift, pixels, correlation):
    count = (2 * radius + 1) ** 2
    patch, here, slopes = np.empty(count), np.empty(count), np.empty((count, 6))
    inverse, shift = np.empty((6, 6)), np.empty((2, 2))
    square, ready = -1.0, -1
    for entry in range(len(source)):
        same = ready >= 0 and source[entry] == source[ready] and np.all(centre[entry] == centre[ready])
        if not same:
            square = _prepare(images[source[entry]], centre[entry], radius, patch, slopes, inverse, shift)
            ready = entry
        if square > 0:
            correlation[entry] = _search(
                images[target[entry]],
                expected[entry],
                shape[entry],
                radius,
                max_shift,
                patch,
                slopes,
                inverse,
                shift,
                square,
                here,
                pixels[entry],
            )


@njit(nogil=True, cache=True)
def _sample(image, x, y):
    column, row = int(np.floor(x)), int(np.floor(y))
    right, down = x - column, y - row
    above = (1 - right) * image[row, column] + right * image[row, column + 1]
    below = (1 - right) * image[row + 1, column] + right * image[row + 1, column + 1]
    return (1 - down) * above + down * below


@njit(nogil=True, cache=True)
def _prepare(image, centre, radius, patch, slopes, inverse, shift):
    """Cut out a patch; fill its derivatives by place and shape, and what solves for a step of both, or of place alone.

    Returns its sum of squares, or -1 if it is too flat.
    """
    x, y = centre
    height, width = image.shape
    if x < radius + 2 or y < radius + 2 or x > width - radius - 4 or y > height - radius - 4:
        return -1.0
    count = 0
    for row in range(-radius, radius + 1):
        for column in range(-radius, radius + 1):
            patch[count] = _sample(image, x + column, y + row)
            across = (_sample(image, x + column + 1, y + row) - _sample(image, x + column - 1, y + row)) / 2
            down = (_sample(image, x + column, y + row + 1) - _sample(image, x + column, y + row - 1)) / 2
            slopes[count, 0], slopes[count, 1] = across, down
            slopes[count, 2], slopes[count, 3] = across * column / radius, across * row / radius
            slopes[count, 4], slopes[count, 5] = down * column / radius, down * row / radius
            count += 1
    patch -= patch.mean()
    for kind in range(6):
        slopes[:, kind] -= slopes[:, kind].mean()
    products = np.zeros((6, 6))
    for index in range(count):
        for one in range(6):
            for other in range(6):
                products[one, other] += slopes[index, one] * slopes[index, other]
    total = products[0, 0] + products[1, 1]
    apart = np.sqrt((products[0, 0] - products[1, 1]) ** 2 + 4 * products[0, 1] ** 2)
    if (total - apart) / 2 < count * _CORNER:
        return -1.0
    shift[:] = np.linalg.inv(products[:2, :2])
    for kind in range(2, 6):
        products[kind, kind] += count * _STIFFNESS
    inverse[:] = np.linalg.inv(products)
    return (patch**2).sum()


@njit(nogil=True, cache=True)
def _search(image, expected, shape, radius, max_shift, patch, slopes, inverse, shift, square, here, found):
    """Refine the place of a patch, in `found`; return its correlation there or -1."""
    height, width = image.shape
    x, y = expected
    xx, xy, yx, yy = shape[0, 0], shape[0, 1], shape[1, 0], shape[1, 1]
    correlation = -1.0
    for iteration in range(_ITERATIONS + 1):
        reach_x, reach_y = radius * (abs(xx) + abs(xy)) + 2, radius * (abs(yx) + abs(yy)) + 2
        if not (reach_x < x < width - reach_x and reach_y < y < height - reach_y):
            return -1.0
        index = 0
        for row in range(-radius, radius + 1):
            for column in range(-radius, radius + 1):
                here[index] = _sample(image, x + xx * column + xy * row, y + yx * column + yy * row)
                index += 1
        mean = here.mean()
        own, product = 0.0, 0.0
        for index in range(len(here)):
            here[index] -= mean
            own += here[index] ** 2
            product += here[index] * patch[index]
        if own < 1e-6:
            return -1.0
        correlation = product / np.sqrt(own * square)
        if iteration == _ITERATIONS:
            break
        contrast = np.sqrt(square / own)
        slope = np.zeros(6)
        for index in range(len(here)):
            difference = here[index] * contrast - patch[index]
            for kind in range(6):
                slope[kind] += slopes[index, kind] * difference
        if iteration < _SHIFTS:
            step = np.zeros(6)
            step[0] = shift[0, 0] * slope[0] + shift[0, 1] * slope[1]
            step[1] = shift[1, 0] * slope[0] + shift[1, 1] * slope[1]
        else:
            step = inverse @ slope
        # The map of the patch is composed with the inverse of the step's.
        a, b, c, d = 1 + step[2] / radius, step[3] / radius, step[4] / radius, 1 + step[5] / radius
        area = a * d - b * c
        if not 0.3 < area < 3:
            return -1.0
        a, b, c, d = d / area, -b / area, -c / area, a / area
        right, down = -(a * step[0] + b * step[1]), -(c * step[0] + d * step[1])
        x, y = x + xx * right + xy * down, y + yx * right + yy * down
        xx, xy, yx, yy = xx * a + xy * c, xx * b + xy * d, yx * a + yy * c, yx * b + yy * d
        if abs(x - expected[0]) > max_shift or abs(y - expected[1]) > max_shift:
            return -1.0
        if iteration > _SHIFTS and step[0] ** 2 + step[1] ** 2 < _STEP**2:
            break
    found[0], found[1] = x, y
    return correlation
