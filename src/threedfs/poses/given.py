"""Given cameras for the working frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.lens import Lens

_FEWEST_POSED = 8


@dataclass(frozen=True)
class GivenCamera:
    """One camera from a file, with or without an image of it.

    Attributes
    ----------
    name : str
        Stem of its image.
    video_frame : int or None
        Index of the video frame, where the file tells it.
    lens : Lens
        Intrinsics and distortion, integer pixel centres. Its camera's width and height are 0 where the format does
        not state the size of the image: then it is that of the source.
    cam_from_world : (4, 4) float64
    """

    name: str
    video_frame: int | None
    lens: Lens
    cam_from_world: np.ndarray


def find_cameras(
    cameras: Sequence[GivenCamera], names: Sequence[str], indices: np.ndarray, *, numbered: bool
) -> dict[int, GivenCamera]:
    """Find the given camera of each working frame.

    Parameters
    ----------
    cameras : sequence of GivenCamera
    names : sequence of str
        Of the frames.
    indices : (N,) int64
        Of the frames in their source.
    numbered : bool
        Frames of a video: they are found by the camera's `video_frame`, or where no camera has one by its name read as
        a number. Photos are found by name.

    Returns
    -------
    dict
        By frame number (position in `names`); frames without a camera are absent.

    Raises
    ------
    UserError
        If fewer than two frames have a camera, as then nothing can be triangulated.
    """
    if not numbered:
        by_key = {camera.name: camera for camera in cameras}
        keys = list(names)
    elif any(camera.video_frame is not None for camera in cameras):
        by_key = {camera.video_frame: camera for camera in cameras}
        keys = [int(index) for index in indices]
    else:
        by_key = {int(camera.name): camera for camera in cameras if camera.name.isdecimal()}
        keys = [int(index) for index in indices]
    found = {number: by_key[key] for number, key in enumerate(keys) if key in by_key}
    if len(found) < 2:
        raise UserError(
            f"poses: expected given cameras for at least two frames, got {len(found)} of {len(names)}; frames are "
            f"named {names[0]}, ..., {names[-1]} and cameras {cameras[0].name}, ..., {cameras[-1].name}; "
            "make the names agree."
        )
    return found


def check_enough_given(posed: int, frames: int) -> None:
    """Check that frames with a given camera are enough to see an object from around.

    Raises
    ------
    UserError
        If they are fewer than eight, and than half.
    """
    fewest = min(_FEWEST_POSED, (frames + 1) // 2)
    if posed < fewest:
        raise UserError(
            f"poses: expected given cameras for at least {fewest} of the {frames} frames, got "
            f"{posed}; give cameras of more frames, or none: then they are estimated."
        )


def state_size(lens: Lens, source_shape: tuple[int, int]) -> Lens:
    """Return a lens with the size of its images: that of the source (H, W), if it states none (0)."""
    if lens.camera.width:
        return lens
    return replace(lens, camera=replace(lens.camera, width=source_shape[1], height=source_shape[0]))


def fit_lens(lens: Lens, source_shape: tuple[int, int], shape: tuple[int, int]) -> Lens:
    """Scale a given lens to the working frames.

    Parameters
    ----------
    lens : Lens
        For images of its stated size, or of the source if it states none (0).
    source_shape, shape : (int, int)
        (H, W) of the source and of the working frames.

    Raises
    ------
    UserError
        If its images have another aspect ratio than the frames.
    """
    lens = state_size(lens, source_shape)
    stated, wanted = lens.camera.width / lens.camera.height, shape[1] / shape[0]
    # Rounding the working size to whole pixels changes the ratio by less than one pixel of the shorter side.
    if abs(stated / wanted - 1) > 1.5 / min(shape):
        raise UserError(
            f"poses: expected given cameras for images of the frames' shape, got {lens.camera.width}x"
            f"{lens.camera.height} for frames of {source_shape[1]}x{source_shape[0]}; are the images cropped or "
            "rotated?"
        )
    return lens.resize(shape[1], shape[0])


def shared_distortion(lenses: Sequence[Lens]) -> tuple[float, float]:
    """Return (k1, k2) of lenses that agree in it.

    Raises
    ------
    UserError
        If they differ: the frames are undistorted by one lens.
    """
    found = sorted({(lens.k1, lens.k2) for lens in lenses})
    if len(found) > 1:
        raise UserError(
            f"poses: expected one radial distortion for all given cameras, got {len(found)}, e.g. {found[0]} and "
            f"{found[-1]}; undistort the images first, or reconstruct them with one shared camera."
        )
    return found[0]
