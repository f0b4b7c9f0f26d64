"""Parameters of the features stage (Section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class FeaturesParams:
    """Which keypoints of which frames are matched to find the cameras."""

    max_frames: int = parameter(
        75, "most frames of a video that keypoints are looked for in, at uniform steps", minimum=8
    )
    max_gap: float = parameter(
        0.5, "longest time between two of them; where frames are rarer, in each", unit="s", minimum=0
    )
    max_features: int = parameter(1200, "most SIFT keypoints of a frame of a video, the largest kept", minimum=100)
    max_photo_features: int = parameter(2048, "the same of a photo, which fewer others overlap", minimum=100)
    min_contrast: float = parameter(
        0.00667,
        "least contrast of a keypoint; smaller finds more on faint texture",
        unit="grey range",
        exclusive_minimum=0,
    )
    min_features: int = parameter(50, "least median number of keypoints of a frame", minimum=8)
