"""Parameters of the render stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.errors import UserError
from threedfs.params.field import parameter


@dataclass(frozen=True)
class RenderParams:
    """How many images of a rendered sequence are made, and how well; their content is the take's."""

    frames: int = parameter(120, "frames of the video; they share the take's 8 s evenly", minimum=2)
    width: int = parameter(640, "width of the images, 4:3; a multiple of 8", unit="pixel", minimum=64)
    samples: int = parameter(2, "images averaged for a frame, each at its own place in the pixel", minimum=1)
    shadow_rays: int = parameter(32, "rays cast to the lamp from each point that light is stored at", minimum=1)
    ambient_rays: int = parameter(64, "the same to all sides", minimum=1)
    mask_step: int = parameter(5, "every so many frames a true mask and a true depth image is written", minimum=1)
    unseen_views: int = parameter(24, "views with a true mask and no image", minimum=0, maximum=99)
    quality: int = parameter(
        20, "constant rate factor of the video: 18 is nearly lossless, 28 is coarse", minimum=0, maximum=51
    )

    def __post_init__(self) -> None:
        """Refuse a size that the video cannot have."""
        if self.width % 8:
            raise UserError(f"configuration, render.width: expected a multiple of 8, got {self.width}.")
