"""Parameters of the poses stage (Section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class PosesParams:
    """What a user may set about camera poses and sparse points."""

    overlap: int = parameter(5, "a frame of a video with keypoints is matched with so many following ones", minimum=1)
    gap_overlap: int = parameter(15, "the same where some frames got no pose, to match over blurred ones", minimum=1)
    max_ratio: float = parameter(
        0.8, "largest ratio of the nearest to the second nearest descriptor's angle", exclusive_minimum=0, maximum=1
    )
    max_descriptor_angle: float = parameter(
        0.7, "largest angle between matching descriptors", unit="radian", exclusive_minimum=0
    )
    min_matches: int = parameter(15, "pairs of frames with fewer matches are dropped", minimum=8)
    max_match_error: float = parameter(
        4.0, "largest distance of a match from its epipolar line", unit="pixel", exclusive_minimum=0
    )
    focal_factor: float = parameter(
        1.2, "first guess of an unknown focal length", unit="longest image side", exclusive_minimum=0
    )
    closures: bool = parameter(True, "look for loop closures in a video")
    closure_overlap: float = parameter(
        0.4,
        "loop closures are looked for between frames that should see at least this share of points in common",
        exclusive_minimum=0,
        maximum=1,
    )
    closure_angle: float = parameter(
        30.0,
        "points count as seen in common if the directions to the frames differ by less",
        unit="degree",
        exclusive_minimum=0,
        maximum=90,
    )
    closure_gap: int = parameter(24, "least distance of the frames of a loop closure", unit="working frame", minimum=2)
    closures_per_frame: int = parameter(3, "most loop closures looked for from a frame", minimum=1)
    closure_rotation: float = parameter(
        8.0,
        "largest rotation between the relative pose of a loop closure and that of the path",
        unit="degree",
        exclusive_minimum=0,
        maximum=45,
    )
    closure_direction: float = parameter(
        15.0, "largest angle between the translations of the two", unit="degree", exclusive_minimum=0, maximum=45
    )
    closure_cover: float = parameter(
        0.1,
        "least share of the image that the matches of a loop closure must cover, or they lie on one object only",
        minimum=0,
        maximum=1,
    )
    second_try_inliers: int = parameter(
        15, "least known points for the pose of a frame that the first try left out", minimum=6
    )
    second_try_share: float = parameter(
        0.15, "least share of them among its matches with known points", minimum=0, maximum=1
    )
    followed_points: int = parameter(
        300, "most points followed from each of the two nearest frames into one without keypoints", minimum=20
    )
    followed_share: float = parameter(0.25, "least share of them that must support its pose", minimum=0, maximum=1)
    patch_points: int = parameter(6000, "most points that are followed as patches", minimum=100)
    patch_radius: int = parameter(7, "of a patch", unit="pixel", minimum=3, maximum=30)
    patch_span: int = parameter(
        24,
        "a point is looked for in frames of a video within this many of one that sees it",
        unit="working frame",
        minimum=0,
    )
    patch_angle: float = parameter(
        30.0,
        "patches are followed to frames whose viewing directions differ by at most this",
        unit="degree",
        minimum=1,
        maximum=90,
    )
    patch_shift: float = parameter(
        4.0, "largest distance of a patch from where it is expected", unit="pixel", exclusive_minimum=0
    )
    patch_correlation: float = parameter(
        0.85, "least correlation of a patch with what it is found at", minimum=0, maximum=1
    )
    patch_observations: int = parameter(
        30, "a frame with fewer patches is adjusted by its keypoints, or has no pose if it has none", minimum=6
    )
    loss_width: float = parameter(
        1.0, "reprojection errors above count less than squared", unit="pixel", exclusive_minimum=0
    )
    pair_angle: float = parameter(
        60.0,
        "given cameras: frames whose optical axes differ more are not matched",
        unit="degree",
        minimum=1,
        maximum=180,
    )
    pairs_per_frame: int = parameter(
        20, "given cameras: a frame is matched with at most so many nearest ones", minimum=1
    )
    max_point_error: float = parameter(
        2.0, "points with a larger mean reprojection error are dropped", unit="pixel", exclusive_minimum=0
    )
    min_point_angle: float = parameter(2.0, "points seen under a smaller angle are dropped", unit="degree", minimum=0)
    min_point_track: int = parameter(
        3, "points seen by fewer frames are dropped, as long as min_points remain", minimum=2
    )
    min_points: int = parameter(500, "with fewer points, those that only two frames see are kept", minimum=0)
    least_points: int = parameter(50, "given cameras: least number of points to go on with", minimum=1)
    min_agreement: float = parameter(
        0.5,
        "least share of the matches of given cameras, or of loop closures, that agree with the poses",
        minimum=0,
        maximum=1,
    )
    max_flat_share: float = parameter(0.98, "largest share of pairs of frames without parallax", minimum=0, maximum=1)
    min_motion: float = parameter(
        3.0, "least motion of the image between frames, or the camera is called static", unit="pixel", minimum=0
    )
    min_registered: float = parameter(0.8, "least share of the frames with a pose", minimum=0, maximum=1)
    max_reprojection_error: float = parameter(2.0, "largest mean reprojection error", unit="pixel", exclusive_minimum=0)
    min_track_length: float = parameter(2.5, "least mean number of frames that see a point", minimum=2)
    min_triangulation_angle: float = parameter(
        2.5, "least median angle under which points are seen", unit="degree", minimum=0
    )
    step_spacing: float = parameter(
        0.333, "steps of a video's camera path are taken over so much time", unit="s", exclusive_minimum=0
    )
    max_step_ratio: float = parameter(
        6.0, "largest step of a video's camera path over its median step", exclusive_minimum=1
    )
