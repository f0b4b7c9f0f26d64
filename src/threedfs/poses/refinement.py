"""Reconstructions made exact: points are followed as patches into all frames near in time, and all is adjusted.

Keypoints are found anew in every frame, half a pixel off here and there. A patch of one frame found again in the others
is the same spot of a surface to a tenth of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from threedfs.colmap.adjustment import adjust_bundle
from threedfs.geometry.rigid import camera_centres
from threedfs.poses.closures import stays_on_path
from threedfs.poses.patches import Patches, follow_patches
from threedfs.poses.scene import Scene, make_scene, observation_errors

_LEAST = 3  # frames that see a point
_ROUNDS = 2  # of adjustment; between them far observations are left out
_FAR = 3.0  # errors above so many times the median of their frame


@dataclass(frozen=True)
class RefinementRule:
    """How patches are followed.

    Attributes
    ----------
    patch_points : int
        Points followed, those that most frames see.
    patch_radius : int
        Of a patch, pixels.
    patch_span : int
        A point is looked for in frames at most so far, in time, from one that sees it.
    patch_angle : float
        Largest angle between the rays to the patch's own frame and another, radians.
    patch_shift : float
        Farthest from where the point is expected, pixels.
    patch_correlation : float
        Of a patch with what it is found at.
    patch_observations : int
        A frame with fewer keeps the observations that it had.
    loss_width : float
        See `adjust_bundle`, pixels.
    max_bend : float
        Most that a frame may be turned against the middle of the path, radians; else nothing is changed.
    """

    patch_points: int
    patch_radius: int
    patch_span: int
    patch_angle: float
    patch_shift: float
    patch_correlation: float
    patch_observations: int
    loss_width: float
    max_bend: float


def refine_scene(
    scene: Scene, images: np.ndarray, rule: RefinementRule, *, refine_poses: bool, refine_lens: bool, threads: int
) -> Scene:
    """Observe the points anew as patches and adjust poses, points and, if it is not known, the lens.

    Where frames are so far apart that patches give fewer observations than keypoints, nothing is changed.

    Parameters
    ----------
    scene : Scene
    images : (F, H, W) uint8
        Grey images of all frames.
    rule : RefinementRule
    refine_poses, refine_lens : bool
        Whether they are changed. Frames of estimated poses that see nothing lose theirs.
    threads : int
        Changes no result.
    """
    observed = observe_patches(scene, images, rule, threads)
    if refine_poses:
        seeing = set(observed.points.track_frame.tolist())
        observed = replace(
            observed, cam_from_world={frame: pose for frame, pose in scene.cam_from_world.items() if frame in seeing}
        )
    if len(observed.pixels) < len(scene.pixels):
        return scene
    posed = observed.cam_from_world
    for _ in range(_ROUNDS):
        lenses, poses, xyz = adjust_bundle(
            observed.lenses,
            observed.cam_from_world,
            observed.points.xyz,
            observed.points.track_point,
            observed.points.track_frame,
            observed.pixels,
            loss_width=rule.loss_width,
            refine_poses=refine_poses,
            refine_lens=refine_lens,
        )
        moved = replace(observed, lenses=lenses, cam_from_world=poses, points=replace(observed.points, xyz=xyz))
        observed = _keep(moved, _near(moved))
    return observed if stays_on_path(posed, observed.cam_from_world, rule.max_bend) else scene


def observe_patches(scene: Scene, images: np.ndarray, rule: RefinementRule, threads: int) -> Scene:
    """Replace the observations of a scene by those of patches; points that fewer than three frames see are left out.

    Parameters
    ----------
    scene, images, rule, threads
        See `refine_scene`.
    """
    points = scene.points
    own = _own_observations(scene, rule.patch_points)
    number, frame = _expected_frames(scene, own, rule.patch_span, len(images))
    expected, shape, alike = _predict(scene, own[number], frame, images.shape[1:], rule.patch_angle)
    own_of = own[number][alike]
    patches = Patches(points.track_frame[own_of], frame[alike], scene.pixels[own_of], expected[alike], shape[alike])
    pixels, correlation = follow_patches(
        images, patches, radius=rule.patch_radius, max_shift=rule.patch_shift, threads=threads
    )
    found = correlation >= rule.patch_correlation
    track_point = np.concatenate([points.track_point[own], points.track_point[own_of[found]]])
    track_frame = np.concatenate([points.track_frame[own], patches.target[found]])
    pixels = np.concatenate([scene.pixels[own], pixels[found]])
    few = np.bincount(track_frame, minlength=len(images)) < rule.patch_observations
    before = np.flatnonzero(few[points.track_frame])
    new = ~few[track_frame]
    return make_scene(
        scene.lenses,
        scene.cam_from_world,
        points.xyz,
        points.rgb,
        np.concatenate([track_point[new], points.track_point[before]]),
        np.concatenate([track_frame[new], points.track_frame[before]]),
        np.concatenate([pixels[new], scene.pixels[before]]),
        least=_LEAST,
    )


def _own_observations(scene: Scene, most: int) -> np.ndarray:
    """Return the middle observation of each of the `most` longest tracks: patches are cut from it."""
    starts = np.searchsorted(scene.points.track_point, np.arange(len(scene.points.xyz) + 1))
    length = np.diff(starts)
    longest = np.sort(np.argsort(-length, kind="stable")[:most])
    longest = longest[length[longest] >= _LEAST]
    return starts[longest] + length[longest] // 2


def _expected_frames(scene: Scene, own: np.ndarray, span: int, frames: int) -> tuple[np.ndarray, np.ndarray]:
    """List the posed frames near in time to those that see a point, but for its own: index in `own`, and frame."""
    points = scene.points
    number = np.full(len(points.xyz), -1)
    number[points.track_point[own]] = np.arange(len(own))
    used = number[points.track_point] >= 0
    row, frame = number[points.track_point[used]], points.track_frame[used]
    change = np.zeros((len(own), frames + 1), np.int32)
    np.add.at(change, (row, np.maximum(frame - span, 0)), 1)
    np.add.at(change, (row, np.minimum(frame + span + 1, frames)), -1)
    near = change.cumsum(axis=1)[:, :frames] > 0
    near[:, np.setdiff1d(np.arange(frames), list(scene.cam_from_world))] = False
    near[np.arange(len(own)), points.track_frame[own]] = False
    return np.nonzero(near)


def _predict(
    scene: Scene, own: np.ndarray, target: np.ndarray, image: tuple[int, int], max_angle: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Predict where a patch that faces its own frame is seen in another, how it is drawn there, and if it looks alike.

    Returns (K, 2) pixels, (K, 2, 2) maps of offsets, (K,) bool.
    """
    source = scene.points.track_frame[own]
    xyz = scene.points.xyz[scene.points.track_point[own]]
    frames = sorted(scene.cam_from_world)
    rank = np.zeros(frames[-1] + 1, np.int64)
    rank[frames] = np.arange(len(frames))
    poses = np.array([scene.cam_from_world[frame] for frame in frames])
    focal = np.array([(scene.lenses[frame].camera.fx, scene.lenses[frame].camera.fy) for frame in frames])
    centres = camera_centres(poses)
    pose = poses[rank[source]]
    depth = np.einsum("kj,kj->k", pose[:, 2, :3], xyz) + pose[:, 2, 3]
    step = depth[:, None] / focal[rank[source]]
    corners = [xyz, xyz + step[:, :1] * pose[:, 0, :3], xyz + step[:, 1:] * pose[:, 1, :3]]
    seen, right, below = (_project(scene, target, corner) for corner in corners)
    shape = np.stack([right - seen, below - seen], axis=-1)
    rays = [xyz - centres[rank[frame]] for frame in (source, target)]
    lengths = [np.linalg.norm(ray, axis=1) for ray in rays]
    cosine = np.einsum("kj,kj->k", *rays) / (lengths[0] * lengths[1])
    inside = np.all((seen >= 0) & (seen <= np.array(image)[::-1] - 1), axis=1)
    size = np.linalg.det(np.where(np.isfinite(shape), shape, 0))
    return seen, shape, inside & (cosine >= np.cos(max_angle)) & (size > 0.4) & (size < 2.5)


def _project(scene: Scene, frame: np.ndarray, xyz: np.ndarray) -> np.ndarray:
    """Return the pixels (K, 2) at which frames (K,) see points (K, 3); NaN behind the camera."""
    pixels = np.full((len(xyz), 2), np.nan)
    for number, pose in scene.cam_from_world.items():
        here = np.flatnonzero(frame == number)
        in_camera = xyz[here] @ pose[:3, :3].T + pose[:3, 3]
        depth = np.where(in_camera[:, 2:] > 0, in_camera[:, 2:], np.nan)
        pixels[here] = scene.lenses[number].denormalise(in_camera[:, :2] / depth)
    return pixels


def _near(scene: Scene) -> np.ndarray:
    """Say which observations are not much farther from their points than others of their frame, (M,) bool."""
    errors = observation_errors(scene)
    near = np.zeros(len(errors), bool)
    for frame in np.unique(scene.points.track_frame):
        here = scene.points.track_frame == frame
        near[here] = errors[here] <= _FAR * np.median(errors[here])
    return near


def _keep(scene: Scene, kept: np.ndarray) -> Scene:
    points = scene.points
    return make_scene(
        scene.lenses,
        scene.cam_from_world,
        points.xyz,
        points.rgb,
        points.track_point[kept],
        points.track_frame[kept],
        scene.pixels[kept],
        least=_LEAST,
    )
