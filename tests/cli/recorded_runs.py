"""When each job of real runs on two cores ended, in seconds after the command began, as Snakemake logged it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from threedfs.cli.costs import Size


@dataclass(frozen=True)
class Recorded:
    """A run.

    Attributes
    ----------
    quality : str
    cold : bool
        Whether it had to compile all kernels.
    size : Size
    seconds : float
        From its begin to its end.
    taken : sequence of str
        Rules whose results were in the store.
    ends : str
        Pairs RULE:SECOND in their order.
    """

    quality: str
    cold: bool
    size: Size
    seconds: float
    taken: Sequence[str]
    ends: str

    @property
    def jobs(self) -> list[tuple[str, float]]:
        """Rule and end of each job, seconds."""
        pairs = (pair.split(":") for pair in self.ends.split())
        return [(rule, float(end)) for rule, end in pairs]


RUNS = {
    "sample, kernels compiled": Recorded(
        "normal",
        True,
        Size(120, 24, 182474),
        290,
        [],
        """
        frames:5 features:10 poses:42 keyframes:44 shrink:48 scout:61 depth:81 consistency:88 fuse_scene:97
        locate:120 crops:125 cues:157 depth:180 evaluate_reconstruction:183 consistency:190 fuse_object:200
        locate_object:201 segment:223 pixel_masks:227 evaluate:229 cut_object:233 evaluate:236 surface:274
        evaluate:279 texture:285 photographs:289
        """,
    ),
    "sample": Recorded(
        "normal",
        False,
        Size(120, 24, 182474),
        179,
        [],
        """
        frames:6 features:10 poses:29 keyframes:31 shrink:35 scout:41 depth:48 consistency:51 fuse_scene:56
        locate:66 crops:70 cues:86 depth:102 evaluate_reconstruction:105 consistency:111 fuse_object:117
        locate_object:119 segment:133 pixel_masks:135 evaluate:138 cut_object:138 evaluate:141 surface:168
        evaluate:172 texture:174 photographs:178
        """,
    ),
    "phone video, draft": Recorded(
        "draft",
        False,
        Size(71, 12, 80293),
        46,
        [],
        """
        frames:5 features:8 poses:14 keyframes:15 shrink:16 scout:17 depth:19 consistency:20 fuse_scene:21
        locate:22 crops:25 cues:27 depth:30 consistency:31 fuse_object:33 locate_object:33
        evaluate_reconstruction:33 segment:36 surface:39 evaluate:40 texture:41 photographs:42 scale:42
        pixel_masks:43 evaluate:43
        """,
    ),
    "sample, fine, cameras from the store": Recorded(
        "fine",
        False,
        Size(120, 24, 185723),
        125,
        ["frames", "features", "poses"],
        """
        frames:3 features:3 poses:4 keyframes:5 shrink:7 scout:11 depth:25 consistency:27 fuse_scene:30
        locate:36 crops:38 cues:49 depth:80 consistency:84 fuse_object:87 evaluate_reconstruction:87
        locate_object:88 segment:96 surface:113 evaluate:114 pixel_masks:116 evaluate:116 texture:117
        photographs:119 cut_object:120 evaluate:121
        """,
    ),
    "phone video": Recorded(
        "normal",
        False,
        Size(142, 24, 401163),
        300,
        [],
        """
        frames:11 features:20 poses:40 keyframes:42 shrink:49 scout:55 depth:68 consistency:71 fuse_scene:76
        locate:93 crops:113 cues:130 depth:184 evaluate_reconstruction:186 consistency:198 fuse_object:206
        locate_object:208 segment:230 surface:270 evaluate:277 pixel_masks:277 evaluate:279 cut_object:282
        texture:289 evaluate:290 photographs:300
        """,
    ),
    "phone video, jobs that end at once": Recorded(
        "normal",
        False,
        Size(142, 24, 400620),
        147,
        [],
        """
        frames:7 features:13 poses:25 keyframes:26 shrink:28 scout:31 depth:38 consistency:40 fuse_scene:42
        locate:51 crops:55 cues:64 depth:94 consistency:100 fuse_object:104 evaluate_reconstruction:104
        locate_object:105 segment:116 surface:131 evaluate:133 texture:136 pixel_masks:137 evaluate:137
        photographs:139 scale:139 cut_object:141 evaluate:142
        """,
    ),
    "phone video, idle machine": Recorded(
        "normal",
        False,
        Size(142, 24, 401163),
        255,
        [],
        """
        frames:7 features:15 poses:31 keyframes:32 shrink:36 scout:41 depth:52 consistency:55 fuse_scene:60
        locate:75 crops:85 cues:102 depth:154 evaluate_reconstruction:155 consistency:169 fuse_object:177
        locate_object:179 segment:199 surface:231 evaluate:235 pixel_masks:238 evaluate:240 cut_object:241
        evaluate:245 texture:249 photographs:254
        """,
    ),
    "phone video, fine": Recorded(
        "fine",
        False,
        Size(142, 24, 402235),
        191,
        [],
        """
        frames:8 features:13 poses:23 keyframes:24 shrink:26 scout:28 depth:42 consistency:43
        fuse_scene:45 locate:52 crops:56 cues:64 depth:136 consistency:143 fuse_object:146
        evaluate_reconstruction:147 locate_object:147 segment:158 surface:177 evaluate:178 texture:181
        pixel_masks:182 evaluate:182 photographs:184 cut_object:185 evaluate:186
        """,
    ),
    "phone video, faster machine": Recorded(
        "normal",
        False,
        Size(142, 24, 401163),
        138,
        [],
        """
        frames:8 features:14 poses:24 keyframes:25 shrink:27 scout:29 depth:36 consistency:38
        fuse_scene:40 locate:47 crops:51 cues:60 depth:88 consistency:94 fuse_object:98
        evaluate_reconstruction:98 locate_object:99 segment:109 surface:125 evaluate:126 texture:129
        pixel_masks:130 evaluate:130 photographs:132 cut_object:133 evaluate:134
        """,
    ),
    "short phone video, draft": Recorded(
        "draft",
        False,
        Size(71, 12, 84571),
        48,
        [],
        """
        frames:9 features:11 poses:18 keyframes:19 shrink:20 scout:21 depth:23 consistency:24
        fuse_scene:25 locate:26 crops:29 cues:31 depth:34 consistency:35 fuse_object:36
        evaluate_reconstruction:36 locate_object:36 segment:38 surface:42 evaluate:42 texture:43
        photographs:44 pixel_masks:45 evaluate:45
        """,
    ),
}
