"""The true cameras of a sequence, and the way from the reconstruction's world to theirs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from threedfs.evaluate.pose_error import align_poses
from threedfs.frames.picture import name_video_frame
from threedfs.geometry.similarity import Similarity
from threedfs.poses.given import GivenCamera, find_cameras, state_size
from threedfs.types import View

Filmed = tuple[View, tuple[float, float]]
"""A true camera at the resolution of the source, and its distortion (k1, k2)."""


class FrameList(Protocol):
    """What is asked of the working frames: no image.

    It has properties, as frozen lists have attributes that can be read only.
    """

    @property
    def names(self) -> tuple[str, ...]:
        """Of the frames."""

    @property
    def indices(self) -> np.ndarray:
        """(N,) int64, in their source."""

    @property
    def ordered(self) -> bool:
        """Whether they are of a video."""

    @property
    def source_shape(self) -> tuple[int, int]:
        """(H, W) of the source."""


@dataclass(frozen=True)
class TrueCameras:
    """True cameras by name.

    Attributes
    ----------
    seen : mapping of str to Filmed
        Of working frames.
    unseen : mapping of str to Filmed
        Of views without an image; named as their frame would be, so that a mask of the same name is found.
    from_scene : Similarity
        From the reconstruction's world to that of the true cameras.
    """

    seen: Mapping[str, Filmed]
    unseen: Mapping[str, Filmed]
    from_scene: Similarity


def relate_cameras(cameras: Sequence[GivenCamera], posed: Sequence[View], frames: FrameList) -> TrueCameras:
    """Find the true camera of each frame, and align the estimated cameras with them.

    Parameters
    ----------
    cameras : sequence of GivenCamera
        True ones, of frames and of views without an image.
    posed : sequence of View
        Working frames with an estimated pose.
    frames : FrameList

    Raises
    ------
    UserError
        If the cameras belong to other frames, or are too few or too much in line to be aligned with.
    """
    found = find_cameras(cameras, frames.names, frames.indices, numbered=frames.ordered)
    seen = {frames.names[number]: camera for number, camera in found.items()}
    taken = {camera.name for camera in seen.values()}
    unseen = {_frame_name(camera, frames): camera for camera in cameras if camera.name not in taken}
    common = [view for view in posed if view.name in seen]
    return TrueCameras(
        {name: _film(camera, frames) for name, camera in seen.items()},
        {name: _film(camera, frames) for name, camera in unseen.items()},
        align_poses([view.cam_from_world for view in common], [seen[view.name].cam_from_world for view in common]),
    )


def _frame_name(given: GivenCamera, frames: FrameList) -> str:
    if frames.ordered and given.video_frame is not None:
        return name_video_frame(given.video_frame)
    return name_video_frame(int(given.name)) if frames.ordered and given.name.isdecimal() else given.name


def _film(given: GivenCamera, frames: FrameList) -> Filmed:
    lens = state_size(given.lens, frames.source_shape)
    return View(given.name, lens.camera, given.cam_from_world), (lens.k1, lens.k2)
