"""Continuity of a video's camera path: a path that repeated artwork has folded jumps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from threedfs.geometry.rigid import camera_centres


def step_ratio(times: np.ndarray, cam_from_world: np.ndarray, spacing: float) -> float:
    """Return the largest over the median step of the path at equal time spacing.

    Parameters
    ----------
    times : (N,) float64
        Seconds, ascending.
    cam_from_world : (N, 4, 4) float64
        In order of time.
    spacing : float
        Seconds between two samples of the path; less in a video too short for eight steps, and at least the
        median spacing of `times`.

    Returns
    -------
    float
        1 for uniform motion; infinite if the camera rests more than half of the time and moves in between;
        NaN with fewer than three samples.
    """
    if len(times) < 3:
        return float("nan")
    centres = camera_centres(cam_from_world)
    spacing = max(min(spacing, (times[-1] - times[0]) / 8), float(np.median(np.diff(times))))
    count = int(np.floor((times[-1] - times[0]) / spacing + 1e-6))
    samples = times[0] + spacing * np.arange(count + 1)
    path = np.stack([np.interp(samples, times, centres[:, axis]) for axis in range(3)], axis=1)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    if len(steps) < 2:
        return float("nan")
    median = float(np.median(steps))
    return float(steps.max()) / median if median > 0 else float("inf")


def turns_around(cam_from_world: np.ndarray) -> float:
    """Return how often the path (N, 4, 4), in order of time, goes about what the cameras look at.

    The angle is counted about the axis in which the centres extend least, around the point nearest to all
    optical axes, from its smallest value to its largest.
    """
    centres = camera_centres(cam_from_world)
    axes = cam_from_world[:, 2, :3]
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    middle = np.linalg.lstsq(across.sum(0), np.einsum("nij,nj->i", across, centres), rcond=None)[0]
    _, _, directions = np.linalg.svd(centres - centres.mean(0), full_matrices=False)
    x, y = ((centres - middle) @ directions[:2].T).T
    angle = np.unwrap(np.arctan2(y, x))
    return float((angle.max() - angle.min()) / (2 * np.pi))


def measure_path(times: np.ndarray, cam_from_world: Mapping[int, np.ndarray], spacing: float) -> dict[str, float]:
    """Return the figures of a video's path: `step_ratio` and `turns` (see `step_ratio`, `turns_around`).

    Parameters
    ----------
    times : (N,) float64
        Of all frames, s.
    cam_from_world : mapping of int to (4, 4) float64
        Poses of those that have one, by frame number.
    spacing : float
        Seconds between two samples of the path.
    """
    numbers = sorted(cam_from_world)
    path = np.array([cam_from_world[number] for number in numbers])
    return {"step_ratio": step_ratio(times[numbers], path, spacing), "turns": turns_around(path)}
