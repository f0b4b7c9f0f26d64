"""Structure from motion of one sequence: near frames first, then over gaps, then loop closures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from threedfs.colmap.mapping import Mapped, map_frames
from threedfs.colmap.verification import Verified
from threedfs.geometry.lens import Lens
from threedfs.poses.closures import ClosureRule, find_closures, stays_on_path
from threedfs.poses.gates import check_mapped, check_motion, check_parallax
from threedfs.poses.matcher import PairMatcher
from threedfs.poses.pairs import exhaustive_pairs, sequential_pairs

VerifiedPairs = Mapping[tuple[int, int], Verified]


@dataclass(frozen=True)
class PathRule:
    """How the path of the camera is estimated.

    Attributes
    ----------
    overlap, gap_overlap : int
        A frame of a video is matched with so many following ones; the second where some frames got no pose.
    min_motion : float
        Least motion of the image between frames, pixels.
    max_flat_share : float
        Largest share of pairs of frames without parallax.
    min_inliers, min_inlier_share : int, float
        Least support for the pose of a frame at the second try, see `map_frames`.
    max_bend : float
        Most that further pairs may turn a frame against the middle of the path, radians.
    min_agreement : float
        Least share of the matches of further pairs that must agree with the path they were added to.
    closure : ClosureRule or None
        None: loop closures are not looked for.
    """

    overlap: int
    gap_overlap: int
    min_motion: float
    max_flat_share: float
    min_inliers: int
    min_inlier_share: float
    max_bend: float
    min_agreement: float
    closure: ClosureRule | None


@dataclass(frozen=True)
class CameraPath:
    """An estimated path of the camera.

    Attributes
    ----------
    mapped : Mapped
        Poses, lens and points.
    motion : float
        Largest median motion of the matches of a pair, pixels.
    flat_share : float
        Share of pairs without parallax.
    closures : int
        Pairs of frames believed to close a loop.
    """

    mapped: Mapped
    motion: float
    flat_share: float
    closures: int


def estimate_path(matcher: PairMatcher, lens: Lens | None, rule: PathRule, note: Callable[[str], None]) -> CameraPath:
    """Estimate the poses of the frames of one camera, and points (Section 3.1).

    Photos are all matched with each other. Frames of a video are matched with those that follow; over larger gaps
    where some got no pose; and where the path so far predicts it, with frames far apart in time.

    Parameters
    ----------
    matcher : PairMatcher
    lens : Lens or None
        Known intrinsics, or None to estimate them.
    rule : PathRule
    note : callable
        Takes what the user may want to know.

    Raises
    ------
    UserError
        If the camera stands still or turns on the spot, or nothing can be mapped.
    """
    frames = matcher.frames
    count = len(frames.features)
    pairs = sequential_pairs(count, rule.overlap) if frames.ordered else exhaustive_pairs(count)
    verified = matcher.verify(pairs, lens)
    motion = check_motion(frames.features, verified, rule.min_motion)
    flat_share = check_parallax(verified, rule.max_flat_share)
    note(f"{len(verified)} of {len(pairs)} pairs of frames verified, {flat_share:.0%} without parallax")
    mapped = check_mapped(_map(matcher, verified, lens, rule), len(verified))
    if frames.ordered and len(mapped.model.cam_from_world) < count:
        note("some frames have no pose: matching over gaps")
        wider = sorted(set(sequential_pairs(count, rule.gap_overlap)) - set(pairs))
        bridges = matcher.verify(wider, lens)
        mapped = _extend(matcher, mapped, verified, bridges, lens, rule, note)
        verified = verified | bridges
    closures = {}
    if frames.ordered and rule.closure is not None:
        closures = find_closures(matcher, mapped, rule.closure, note)
        if closures:
            mapped = _extend(matcher, mapped, verified, closures, lens, rule, note)
    return CameraPath(mapped, motion, flat_share, len(closures))


def _extend(
    matcher: PairMatcher,
    first: Mapped,
    verified: VerifiedPairs,
    added: VerifiedPairs,
    lens: Lens | None,
    rule: PathRule,
    note: Callable[[str], None],
) -> Mapped:
    """Go on from a path with more pairs; return the first path if they bend it."""
    everything = {**verified, **added}
    extended = _map(matcher, everything, lens, rule, start=first)
    if extended is not None and not _follows(matcher, added, extended, rule.min_agreement):
        note("the path has drifted too far to be closed by adjustment: mapping again with all pairs")
        extended = _map(matcher, everything, lens, rule)
    if extended is None or not stays_on_path(first.model.cam_from_world, extended.model.cam_from_world, rule.max_bend):
        note("with more pairs of frames the path bends: the first path is kept")
        return first
    return extended


def _follows(matcher: PairMatcher, added: VerifiedPairs, mapped: Mapped, min_agreement: float) -> bool:
    """Say whether enough of the matches of the added pairs agree with the poses."""
    poses = mapped.model.cam_from_world
    posed = {pair: found.matches for pair, found in added.items() if pair[0] in poses and pair[1] in poses}
    agreeing = matcher.agreeing(posed, dict.fromkeys(poses, mapped.lens), poses, min_matches=1)
    return sum(map(len, agreeing.values())) >= min_agreement * sum(map(len, posed.values()))


def _map(
    matcher: PairMatcher, verified: VerifiedPairs, lens: Lens | None, rule: PathRule, start: Mapped | None = None
) -> Mapped | None:
    return map_frames(
        matcher.frames.features,
        {pair: found.matches for pair, found in verified.items()},
        width=matcher.frames.shape[1],
        height=matcher.frames.shape[0],
        lens=lens,
        focal_factor=matcher.rule.focal_factor,
        min_inliers=rule.min_inliers,
        min_inlier_share=rule.min_inlier_share,
        seed=matcher.seed,
        start=start,
    )
