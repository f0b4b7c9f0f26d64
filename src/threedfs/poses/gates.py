"""Gates: what pose estimation must have reached, each with a sentence and a hint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from threedfs.colmap.mapping import Mapped
from threedfs.colmap.verification import Verified
from threedfs.errors import UserError
from threedfs.types import Features


def check_features(features: Sequence[Features], least: int) -> float:
    """Return the median number of keypoints of a frame.

    Raises
    ------
    UserError
        If it is under `least`: the frames are blank, dark or out of focus.
    """
    median = float(np.median([len(frame.pixels) for frame in features]))
    if median < least:
        raise UserError(
            f"features: expected at least {least} keypoints in half of the frames, got a median of {median:.0f}: the "
            "frames are blank, dark or blurred; film in better light, or put something with texture beside the object."
        )
    return median


def check_motion(features: Sequence[Features], verified: Mapping[tuple[int, int], Verified], least: float) -> float:
    """Return the largest median motion of the matches of a pair, pixels.

    Raises
    ------
    UserError
        If it is under `least`: the camera stands still.
    """
    motion = 0.0
    for (first, second), pair in verified.items():
        shift = features[first].pixels[pair.matches[:, 0]] - features[second].pixels[pair.matches[:, 1]]
        motion = max(motion, float(np.median(np.linalg.norm(shift, axis=1))))
    if verified and motion < least:
        raise UserError(
            f"poses: expected the image to move by at least {least:g} pixels between frames, got {motion:.2g}: the "
            "camera is static and gives no parallax; walk around the object while filming."
        )
    return motion


def check_parallax(verified: Mapping[tuple[int, int], Verified], largest_flat_share: float) -> float:
    """Return the share of pairs that one homography explains.

    Raises
    ------
    UserError
        If it is over `largest_flat_share`: the camera turns on the spot.
    """
    flat = float(np.mean([pair.flat for pair in verified.values()])) if verified else 0.0
    if flat > largest_flat_share:
        raise UserError(
            f"poses: expected at least {1 - largest_flat_share:.0%} of the pairs of frames to show parallax, got "
            f"{1 - flat:.0%}: the camera turns on the spot, or nothing but one plane is in view; walk around the "
            "object while filming."
        )
    return flat


def check_mapped(mapped: Mapped | None, verified_pairs: int) -> Mapped:
    """Return what the mapper made.

    Raises
    ------
    UserError
        If it made nothing.
    """
    if mapped is None:
        raise UserError(
            f"poses: expected two frames from which the scene can be started, got none among {verified_pairs} pairs "
            "that match: frames share too little texture or no parallax; walk around the object, slowly, in good light."
        )
    return mapped


def check_points(points: int, least: int) -> None:
    """Pass given cameras with which at least `least` points could be triangulated.

    Raises
    ------
    UserError
        If there are fewer.
    """
    if points < least:
        raise UserError(
            f"poses: expected at least {least} points from the given cameras, got {points}: the cameras do not fit "
            "the images; check their names, axes, direction (camera to world) and the size of the images."
        )


def check_agreement(agreeing: int, matches: int, least_share: float) -> float:
    """Return the share of matches that agree with the epipolar geometry of given cameras.

    Raises
    ------
    UserError
        If it is under `least_share`: they are not the cameras of these images.
    """
    share = agreeing / max(matches, 1)
    if share < least_share:
        raise UserError(
            f"poses: expected at least {least_share:.0%} of the matches to agree with the given cameras, got "
            f"{share:.0%} of {matches}: the cameras do not fit the images; check their names, axes, direction (camera "
            "to world) and the size of the images."
        )
    return share


def check_registered(posed: int, frames: int, least_share: float) -> float:
    """Return the share of frames that have a pose.

    Raises
    ------
    UserError
        If it is under `least_share`.
    """
    share = posed / frames
    if share < least_share:
        raise UserError(
            f"poses: expected at least {least_share:.0%} of the frames to get a pose, got {posed} of {frames}: the "
            "others share too few points with them; film slower and without cuts, take more photos in between, "
            "or lower poses.min_registered."
        )
    return share


def check_quality(quality: Mapping[str, float], *, max_error: float, min_track_length: float, min_angle: float) -> None:
    """Pass a reconstruction whose points are seen well.

    Parameters
    ----------
    quality : mapping
        With `reprojection_error` (pixels), `track_length` (frames), `triangulation_angle` (degrees, median).
    max_error, min_track_length, min_angle : float
        Their bounds.

    Raises
    ------
    UserError
        If one is out of bounds.
    """
    if quality["reprojection_error"] > max_error:
        raise UserError(
            f"poses: expected a mean reprojection error of at most {max_error:g} pixels, got "
            f"{quality['reprojection_error']:.2f}: the scene moved or the lens is not radial; keep everything "
            "still, turn off video stabilisation, or give a calibration."
        )
    if quality["triangulation_angle"] < min_angle:
        raise UserError(
            f"poses: expected a median triangulation angle of at least {min_angle:g} degrees, got "
            f"{quality['triangulation_angle']:.2f}: the camera turns on the spot and gives no parallax; "
            "walk around the object while filming."
        )
    if quality["track_length"] < min_track_length:
        raise UserError(
            f"poses: expected points to be seen by {min_track_length:g} frames on average, got "
            f"{quality['track_length']:.2f}: frames overlap too little; film slower or take more photos in between."
        )


def check_continuity(ratio: float, largest: float) -> None:
    """Pass a path whose largest step over its median step, `ratio`, is at most `largest`.

    Raises
    ------
    UserError
        If it is larger: the path jumps.
    """
    if ratio > largest:
        raise UserError(
            f"poses: expected a continuous camera path, its largest step at most {largest:g} times its median step, "
            f"got {ratio:.1f}: the video is cut or repeated texture misled the matching; film in one take with some "
            "of the surroundings in view, or raise poses.max_step_ratio if the camera really moved so."
        )
