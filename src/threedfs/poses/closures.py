"""Loop closures: frames far apart in time that show the same side of the scene again.

Repeated artwork matches as well from the wrong side of an object as from the right one, at the same
reprojection error. So a closure is looked for only where the path of consecutive frames predicts it, and
believed only where the relative pose that its matches give, by themselves, is the predicted one and they
cover more of the image than one object would.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.colmap.mapping import Mapped
from threedfs.colmap.verification import Verified
from threedfs.geometry.lens import Lens
from threedfs.geometry.rigid import camera_centres, invert, rotation_angle
from threedfs.poses.matcher import PairMatcher
from threedfs.poses.pairs import Pairs
from threedfs.types import SparsePoints


@dataclass(frozen=True)
class ClosureRule:
    """Where loop closures are looked for and when they are believed.

    Attributes
    ----------
    max_angle : float
        See `predict_overlap`, radians.
    min_gap, min_overlap, per_frame : int, float, int
        See `closure_candidates`.
    max_rotation, max_direction, min_cover : float
        See `accept_closures`; angles in radians.
    """

    max_angle: float
    min_gap: int
    min_overlap: float
    per_frame: int
    max_rotation: float
    max_direction: float
    min_cover: float


def find_closures(
    matcher: PairMatcher, path: Mapped, rule: ClosureRule, note: Callable[[str], None]
) -> dict[tuple[int, int], Verified]:
    """Match frames far apart in time where the path predicts a common view, and keep the pairs to be believed.

    Parameters
    ----------
    matcher : PairMatcher
    path : Mapped
        The path of consecutive frames.
    rule : ClosureRule
    note : callable
        Takes what the user may want to know.
    """
    poses = path.model.cam_from_world
    frames, overlap = predict_overlap(path.model.points, path.lens, poses, max_angle=rule.max_angle)
    candidates = closure_candidates(
        frames, overlap, min_gap=rule.min_gap, min_overlap=rule.min_overlap, per_frame=rule.per_frame
    )
    closures = accept_closures(
        matcher.frames.pixels,
        matcher.verify(candidates, path.lens),
        poses,
        matcher.frames.shape,
        max_rotation=rule.max_rotation,
        max_direction=rule.max_direction,
        min_cover=rule.min_cover,
    )
    note(f"{len(closures)} of {len(candidates)} candidates for loop closure agree with the path")
    return closures


def predict_overlap(
    points: SparsePoints, lens: Lens, cam_from_world: Mapping[int, np.ndarray], *, max_angle: float
) -> tuple[list[int], np.ndarray]:
    """Predict which share of the points of one frame another frame sees as well.

    Parameters
    ----------
    points : SparsePoints
        `track_frame` holds frame numbers.
    lens : Lens
    cam_from_world : mapping of int to (4, 4) float64
    max_angle : float
        A point is taken to look alike from directions that differ by less, radians.

    Returns
    -------
    frames : list of int
        The N posed frames.
    overlap : (N, N) float64
        The smaller of the two shares of each pair; the diagonal is 1 for frames that see points.
    """
    frames = sorted(cam_from_world)
    poses = np.array([cam_from_world[frame] for frame in frames])
    centres = camera_centres(poses)
    camera = lens.camera
    share = np.zeros((len(frames), len(frames)))
    for row, frame in enumerate(frames):
        seen = points.xyz[points.seen_by(frame)]
        if len(seen) == 0:
            continue
        in_camera = np.einsum("nij,pj->npi", poses[:, :3, :3], seen) + poses[:, None, :3, 3]
        depth = np.where(in_camera[..., 2] > 0, in_camera[..., 2], np.nan)
        u = camera.fx * in_camera[..., 0] / depth + camera.cx
        v = camera.fy * in_camera[..., 1] / depth + camera.cy
        rays = centres[:, None] - seen
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        alike = np.einsum("npi,pi->np", rays, rays[row]) >= np.cos(max_angle)
        shown = (u >= 0) & (u <= camera.width - 1) & (v >= 0) & (v <= camera.height - 1)
        share[row] = (shown & alike).mean(axis=1)
    return frames, np.minimum(share, share.T)


def closure_candidates(
    frames: Sequence[int], overlap: np.ndarray, *, min_gap: int, min_overlap: float, per_frame: int
) -> Pairs:
    """Choose for each frame the earlier ones that it is predicted to overlap best.

    Parameters
    ----------
    frames : sequence of int
        N frame numbers.
    overlap : (N, N) float64
        From `predict_overlap`.
    min_gap : int
        Least difference of frame numbers.
    min_overlap : float
        Least predicted overlap.
    per_frame : int
        Most candidates of a frame.
    """
    number = np.asarray(frames)
    value = np.where(number[:, None] - number >= min_gap, overlap, 0.0)
    pairs = set()
    for row, order in enumerate(np.argsort(-value, axis=1, kind="stable")[:, :per_frame]):
        pairs.update((frames[column], frames[row]) for column in order if value[row, column] >= min_overlap)
    return sorted(pairs)


def agrees_with_path(
    second_from_first: np.ndarray,
    first: np.ndarray,
    second: np.ndarray,
    *,
    max_rotation: float,
    max_direction: float,
) -> bool:
    """Say whether the relative pose of a verified pair is the one that the path predicts.

    Parameters
    ----------
    second_from_first : (4, 4) float64
        Of the matches; its translation has no scale.
    first, second : (4, 4) float64
        cam_from_world of the two frames on the path.
    max_rotation : float
        Largest angle between the two rotations, radians.
    max_direction : float
        Largest angle between the two translations, radians.
    """
    predicted = second @ invert(first)
    rotation = rotation_angle(second_from_first[:3, :3] @ predicted[:3, :3].T)
    lengths = np.linalg.norm(second_from_first[:3, 3]) * np.linalg.norm(predicted[:3, 3])
    cosine = second_from_first[:3, 3] @ predicted[:3, 3] / max(lengths, 1e-300)
    return bool(rotation <= max_rotation and cosine >= np.cos(max_direction))


def covered_share(pixels: np.ndarray, width: int, height: int) -> float:
    """Return the share of the image that the box around most matches covers.

    The box leaves out a twentieth of the pixels (N, 2) on each side, so that a few wrong matches in the
    background do not make those on an object look spread.
    """
    low, high = np.quantile(pixels, (0.05, 0.95), axis=0)
    return float(np.prod((high - low) / (width, height)))


def accept_closures(
    pixels: Sequence[np.ndarray],
    verified: Mapping[tuple[int, int], Verified],
    cam_from_world: Mapping[int, np.ndarray],
    shape: tuple[int, int],
    *,
    max_rotation: float,
    max_direction: float,
    min_cover: float,
) -> dict[tuple[int, int], Verified]:
    """Keep the verified candidates that agree with the path and with the background.

    Parameters
    ----------
    pixels : sequence of (N, 2) float64
        Keypoints of every frame.
    verified : mapping
        Candidates by pair of frame numbers.
    cam_from_world : mapping of int to (4, 4) float64
        The path of consecutive frames.
    shape : (int, int)
        (H, W) of the frames.
    max_rotation, max_direction : float
        See `agrees_with_path`.
    min_cover : float
        Least `covered_share` in both frames.
    """
    accepted = {}
    for (first, second), found in verified.items():
        if found.second_from_first is None:
            continue
        agrees = agrees_with_path(
            found.second_from_first,
            cam_from_world[first],
            cam_from_world[second],
            max_rotation=max_rotation,
            max_direction=max_direction,
        )
        cover = min(
            covered_share(pixels[frame][found.matches[:, side]], shape[1], shape[0])
            for side, frame in enumerate((first, second))
        )
        if agrees and cover >= min_cover:
            accepted[first, second] = found
    return accepted


def stays_on_path(before: Mapping[int, np.ndarray], after: Mapping[int, np.ndarray], max_rotation: float) -> bool:
    """Say whether closing the loops has bent the path only a little.

    Parameters
    ----------
    before, after : mapping of int to (4, 4) float64
        Poses of the path before and after; their world frames may differ.
    max_rotation : float
        Largest change of the rotation between a frame and the middle one of the path, radians.
    """
    frames = sorted(before)
    if not set(frames) <= set(after):
        return False
    middle = frames[len(frames) // 2]
    turned = [
        (after[frame] @ invert(after[middle]))[:3, :3] @ (before[frame] @ invert(before[middle]))[:3, :3].T
        for frame in frames
    ]
    return bool(rotation_angle(np.array(turned)).max() <= max_rotation)
