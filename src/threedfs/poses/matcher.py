"""The frames of a sequence as structure from motion sees them, and the matching of pairs of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.colmap.graph import Matches
from threedfs.colmap.verification import Verified, verify_matches
from threedfs.geometry.lens import Lens
from threedfs.poses.epipolar import agreeing_matches
from threedfs.poses.matching import match_pairs
from threedfs.poses.pairs import Pairs
from threedfs.types import Features


@dataclass(frozen=True)
class FrameFeatures:
    """The keypoints of all frames.

    Attributes
    ----------
    features : sequence of Features
    shape : (int, int)
        (H, W) of the frames.
    ordered : bool
        Whether they are a video's, in the order of time.
    """

    features: Sequence[Features]
    shape: tuple[int, int]
    ordered: bool

    @property
    def pixels(self) -> list[np.ndarray]:
        """Keypoints (N, 2) float64 of every frame."""
        return [frame.pixels for frame in self.features]


@dataclass(frozen=True)
class MatchRule:
    """When keypoints of two frames match.

    Attributes
    ----------
    max_ratio, max_angle : float
        Of descriptors, see `match_pairs`; the angle in radians.
    min_matches : int
        Pairs of frames with fewer matches are dropped.
    max_error : float
        Largest distance of a match from its epipolar line, pixels.
    focal_factor : float
        First guess of an unknown focal length, in longest sides of the image.
    """

    max_ratio: float
    max_angle: float
    min_matches: int
    max_error: float
    focal_factor: float


@dataclass(frozen=True)
class PairMatcher:
    """Matches pairs of frames of one sequence.

    Attributes
    ----------
    frames : FrameFeatures
    rule : MatchRule
    seed : int
        Of the random samples of geometric verification.
    threads : int
        Changes no result.
    """

    frames: FrameFeatures
    rule: MatchRule
    seed: int
    threads: int

    def match(self, pairs: Pairs) -> dict[tuple[int, int], np.ndarray]:
        """Match descriptors; return (M, 2) uint32 keypoint indices by pair of frame numbers."""
        return match_pairs(
            [frame.descriptors for frame in self.frames.features],
            pairs,
            max_ratio=self.rule.max_ratio,
            max_angle=self.rule.max_angle,
            min_matches=self.rule.min_matches,
            threads=self.threads,
        )

    def verify(self, pairs: Pairs, lens: Lens | None) -> dict[tuple[int, int], Verified]:
        """Match descriptors and keep what one geometry explains; with a lens, relative poses are estimated too."""
        return verify_matches(
            self.frames.features,
            self.match(pairs),
            width=self.frames.shape[1],
            height=self.frames.shape[0],
            lens=lens,
            focal_factor=self.rule.focal_factor,
            max_error=self.rule.max_error,
            seed=self.seed,
            threads=self.threads,
        )

    def agreeing(
        self,
        matches: Matches,
        lenses: Mapping[int, Lens],
        cam_from_world: Mapping[int, np.ndarray],
        *,
        min_matches: int,
    ) -> dict[tuple[int, int], np.ndarray]:
        """Keep matches that agree with known poses, of pairs with `min_matches` such (see `agreeing_matches`)."""
        return agreeing_matches(
            self.frames.pixels,
            matches,
            lenses,
            cam_from_world,
            max_error=self.rule.max_error,
            min_matches=min_matches,
        )
