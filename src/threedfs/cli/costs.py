"""What the jobs of a run cost, by the size of the input; measured for the project."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Size:
    """How large an input is; None where that is not known yet.

    Attributes
    ----------
    frames, keyframes : float or None
    pixels : float or None
        Of a keyframe's crop, in the mean.
    """

    frames: float | None = None
    keyframes: float | None = None
    pixels: float | None = None

    def growth(self, other: Size, names: Sequence[str]) -> float:
        """Return how many times as large another input is, by the product of some fields; what is unknown is as here.

        Examples
        --------
        >>> Size(100, 24).growth(Size(50, 12), ("frames", "keyframes"))
        0.25
        """
        factor = 1.0
        for name in names:
            mine, theirs = getattr(self, name), getattr(other, name)
            factor *= theirs / mine if mine and theirs else 1.0
        return factor


@dataclass(frozen=True)
class Cost:
    """Wall time of a job.

    Attributes
    ----------
    seconds : float
        With kernels that are compiled.
    compiling : float
        What compiling them adds, seconds.
    grows : tuple of str
        Fields of `Size` that the seconds are proportional to.
    varies : bool
        Whether the seconds depend on what the images show as well, by a factor of two, so that they say nothing of the
        speed of the machine.
    """

    seconds: float
    compiling: float = 0.0
    grows: tuple[str, ...] = ()
    varies: bool = False


@dataclass(frozen=True)
class Costs:
    """What the jobs of a run cost on an input of a known size.

    Attributes
    ----------
    jobs : mapping of str to tuple of Cost
        Of a rule's first, second, ... job for one sequence.
    size : Size
    cold : bool
        Whether kernels have yet to be compiled.
    """

    jobs: Mapping[str, tuple[Cost, ...]]
    size: Size
    cold: bool = False

    def expect(self, rule: str, count: int, size: Size) -> list[float]:
        """Return the seconds of the `count` jobs of a rule in a run, in their order, on inputs of a size."""
        known = self.jobs.get(rule, (_OTHER,))
        places = [min(rank * len(known) // count, len(known) - 1) for rank in range(count)]
        return [
            self._grow(known[place], size) + (known[place].compiling if self.cold and place not in places[:rank] else 0)
            for rank, place in enumerate(places)
        ]

    def varies(self, rule: str) -> bool:
        """Say whether the seconds of a rule's jobs say nothing of the speed of the machine."""
        return any(cost.varies for cost in self.jobs.get(rule, ()))

    def _grow(self, cost: Cost, size: Size) -> float:
        return cost.seconds * self.size.growth(size, cost.grows)

    def with_seconds(self, seconds: Mapping[str, Sequence[float]]) -> Costs:
        """Return the same with other seconds for the jobs of some rules, as many as they have."""
        changed = {
            rule: tuple(replace(cost, seconds=float(own)) for cost, own in zip(self.jobs[rule], each, strict=True))
            for rule, each in seconds.items()
        }
        return replace(self, jobs={**self.jobs, **changed})


_F, _K, _P = ("frames",), ("keyframes",), ("keyframes", "pixels")
_OTHER = Cost(5.0)
_NORMAL = {
    "frames": (Cost(6.5, grows=_F),),
    "features": (Cost(5.5, grows=_F),),
    "poses": (Cost(12.0, 11.0, _F, varies=True),),
    "keyframes": (Cost(1.0),),
    "shrink": (Cost(2.0),),
    "scout": (Cost(3.0, 7.0, _K),),
    "depth": (Cost(7.5, 13.0, _K), Cost(30.0, 7.0, _P)),
    "consistency": (Cost(1.6, 4.0, _K), Cost(6.5, grows=_P)),
    "fuse_scene": (Cost(2.2, 4.0, _K),),
    "locate": (Cost(6.0, 12.0),),
    "crops": (Cost(4.0, grows=_P),),
    "cues": (Cost(9.0, 15.0, _K),),
    "fuse_object": (Cost(3.7, 4.0, _K),),
    "locate_object": (Cost(1.0),),
    "segment": (Cost(8.0, 8.0, _K),),
    "cut_object": (Cost(2.0, 4.0),),
    "pixel_masks": (Cost(2.0),),
    "surface": (Cost(16.0, 10.0),),
    "texture": (Cost(3.5, 4.0, _P),),
    "photographs": (Cost(2.5),),
    "evaluate": (Cost(0.8),),
    "evaluate_reconstruction": (Cost(0.7),),
    "scale": (Cost(0.4),),
}
"""Measured on two cores of 2026, on a video of 142 frames; what compiling adds, on the sample."""
# Jobs beside the chain that ends in the texture run on the second core; half of their time counts.
_DRAFT = {
    **{"frames": (5,), "features": (3,), "poses": (7.5,), "keyframes": (0.5,), "shrink": (1,), "scout": (1.3,)},
    **{"depth": (2, 3.4), "consistency": (0.9, 1.3), "fuse_scene": (1.4,), "locate": (1.4,), "crops": (2.3,)},
    **{"cues": (2.1,), "fuse_object": (1.1,), "locate_object": (0.5,), "segment": (2.4,), "pixel_masks": (1,)},
    **{"surface": (3.3,), "texture": (1.2,), "photographs": (0.6,), "evaluate": (0.5,)},
}


_MEASURED = Costs(_NORMAL, Size(142, 24, 400_000))
MEASURED = {
    "draft": replace(_MEASURED.with_seconds(_DRAFT), size=Size(72, 12, 80_000)),
    "normal": _MEASURED,
    "fine": _MEASURED.with_seconds({"depth": (14, 76), "surface": (18,)}),
}
"""By quality."""
