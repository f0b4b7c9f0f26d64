"""One labelling of the superpixels of all keyframes and of all voxels (Section 3.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.grid import voxel_places
from threedfs.read_ahead import map_ahead
from threedfs.segment.alpha_expansion import expand
from threedfs.segment.color_model import ColorModel, lab_from_rgb, truncate
from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT, LabelGraph, energy, fold_given
from threedfs.segment.evidence import ImageEvidence, VoxelEvidence
from threedfs.segment.fit_colors import fit_color_model
from threedfs.segment.outline import draw_voxels
from threedfs.segment.pairwise import voxel_pairs
from threedfs.segment.unaries import carve_unary, mean_by, scene_unary, sdf_unary, silhouette_unary, soften_silhouette

_RISE = 1e-4
"""Relative rise of the energy in a move that single precision of the costs explains."""


@dataclass(frozen=True)
class CutRule:
    """Weights and steps of the joint segmentation; `SegmentParams` says more of each value."""

    components: int
    color_superpixels: int
    color_pixels: int
    color_cap: float
    color_weight: float
    roi_weight: float
    silhouette_weight: float
    sdf_weight: float
    scene_weight: float
    carve_weight: float
    first_carving: str
    carve_tolerance: float
    voxel_pair_weight: float
    iterations: int
    stop_swaps: int
    stop_share: float


@dataclass(frozen=True)
class Cut:
    """A labelling.

    Attributes
    ----------
    superpixels : dict of str to (count,) uint8
        Labels by keyframe.
    voxels : (nx, ny, nz) uint8 or None
        None where only images were segmented.
    energies : (M,) float64
        After each move, in order; costs change between iterations.
    swaps : (M,) int64
        Labels that each move changed.
    colors : ColorModel
        Of the last iteration.
    """

    superpixels: dict[str, np.ndarray]
    voxels: np.ndarray | None
    energies: np.ndarray
    swaps: np.ndarray
    colors: ColorModel


def segment_jointly(
    images: Mapping[str, ImageEvidence],
    volume: VoxelEvidence | None,
    rule: CutRule,
    rng: np.random.Generator,
    note: Callable[[str], None] = lambda message: None,
    threads: int = 1,
) -> Cut:
    """Label superpixels and voxels by alpha-expansion, with colours and silhouettes renewed in each iteration.

    Parameters
    ----------
    images : mapping of str to ImageEvidence
    volume : VoxelEvidence or None
        None segments the images alone, tied to each other by their colours only (2D GC of Section 4.3).
    rule : CutRule
    rng : numpy.random.Generator
        Draws what the colour models are learnt from.
    note : callable
        Takes a message to report progress.
    threads : int
        Cores used; the result does not depend on it.

    Raises
    ------
    UserError
        If the trimap leaves nothing to segment, or the object loses all its voxels.
    ArithmeticError
        If a move raises the energy.
    """
    if volume is not None:
        _name_unlinked(images, note)
    nodes = _Nodes(images, volume, rule.voxel_pair_weight)
    labels, model, seed = nodes.first_labels(), None, int(rng.integers(2**31))
    silhouettes, carved = _Average(), _Average()
    energies, swaps = [], []
    views = {name: evidence.view for name, evidence in images.items()}
    valid = {name: evidence.superpixels.index >= 0 for name, evidence in images.items()}
    if volume is not None and rule.first_carving == "cut":
        labels = _cut_images(images, labels, rule, rng, seed, threads)
    for iteration in range(rule.iterations):
        of_images = nodes.split(labels)
        model = _learn_colors(images, of_images, rule, model, rng, seed, threads)
        if volume is not None:
            voxels = nodes.voxels(labels)
            if not (voxels == OBJECT).any():
                raise UserError(
                    "segment: expected voxels of the object, found none left; its colours are those of the background, "
                    "or its masks shrank away: lower segment.carve_weight, or use the method fused_sdf."
                )
            drawn = draw_voxels(voxels == OBJECT, volume.grid, views, threads)
            silhouettes.add(_share_silhouettes(images, drawn, threads))
            if iteration > 0 or rule.first_carving != "none":
                masks = {name: images[name].superpixels.paint(of_images[name] == OBJECT) for name in images}
                carved.add(carve_unary(nodes.open_centres, views, masks, valid, rule.carve_tolerance, threads))
        graph = nodes.connect(model, silhouettes.mean, carved.mean, rule, threads)
        swapped = 0
        now = energy(graph, labels)
        for target in (BACKGROUND, OBJECT, EMPTY) if volume is not None else (BACKGROUND, OBJECT):
            moved = expand(graph, labels, target)
            after = energy(graph, moved)
            if after > now + _RISE * abs(now):
                raise ArithmeticError(f"segment: a move raised the energy from {now} to {after}.")
            swaps.append(int((moved != labels).sum()))
            energies.append(after)
            labels, now, swapped = moved, after, swapped + swaps[-1]
        note(f"iteration {iteration + 1}: energy {now:.0f}, {swapped} labels changed of {len(labels)}")
        if swapped < max(rule.stop_swaps, rule.stop_share * len(labels)):
            break
    return Cut(
        nodes.split(labels),
        None if volume is None else nodes.voxels(labels),
        np.array(energies),
        np.array(swaps, np.int64),
        model,
    )


def _share_silhouettes(images: Mapping[str, ImageEvidence], drawn: Mapping[str, np.ndarray], threads: int):
    """Return how far each superpixel lies within the voxels' soft silhouette, all keyframes in turn."""

    def share(name: str) -> np.ndarray:
        return images[name].superpixels.mean(soften_silhouette(drawn[name], images[name].silhouette_reach))

    return np.concatenate(list(map_ahead(share, images, threads=threads)))


def _cut_images(images, labels, rule, rng, seed, threads):
    """Return the first labels (open nodes,) after the superpixels' have been cut once by the images alone.

    Random masks leave no voxel uncarved; the cut's are the first that know something of the object.
    """
    alone = _Nodes(images, None, rule.voxel_pair_weight)
    first = alone.first_labels()
    model = _learn_colors(images, alone.split(first), rule, None, rng, seed, threads)
    graph = alone.connect(model, None, None, rule, threads)
    for target in (BACKGROUND, OBJECT):
        first = expand(graph, first, target)
    return np.concatenate([first, labels[len(first) :]])


def _name_unlinked(images: Mapping[str, ImageEvidence], note: Callable[[str], None]) -> None:
    """Name the keyframes that no link ties to the voxels; what others see reaches them by the voxels' silhouette."""
    alone = [name for name, evidence in images.items() if len(evidence.link_pairs) == 0]
    if alone:
        note(
            f"{len(alone)} of {len(images)} keyframes have no link with voxels, {', '.join(alone)}: their depth meets "
            "the fused surface nowhere, as in a blurred view, one far from others, or where much of it is lost; "
            "only the voxels' silhouette tells them what others see"
        )


class _Average:
    """The mean of all arrays added so far."""

    def __init__(self) -> None:
        self._sum, self._count = None, 0

    def add(self, values: np.ndarray) -> None:
        self._sum = values.astype(np.float64) if self._sum is None else self._sum + values
        self._count += 1

    @property
    def mean(self) -> np.ndarray | None:
        return None if self._sum is None else self._sum / self._count


class _Nodes:
    """Numbering of all nodes: the superpixels of each image in turn, then the voxels in the order of the grid.

    Labels are of the open nodes only; what the others have is given.
    """

    def __init__(
        self, images: Mapping[str, ImageEvidence], volume: VoxelEvidence | None, voxel_pair_weight: float
    ) -> None:
        self._images, self._volume = images, volume
        counts = [evidence.superpixels.count for evidence in images.values()]
        starts = np.concatenate([[0], np.cumsum(counts)])
        self._starts, self._superpixels = starts, int(starts[-1])
        is_open, first = (
            np.concatenate([getattr(evidence, name) for evidence in images.values()]) for name in ("is_open", "first")
        )
        if not is_open.any():
            raise UserError(
                "segment: expected superpixels between the outer and the inner estimate of the object, found none; "
                "raise segment.outer_level or segment.outer_margin, or lower segment.inner_level."
            )
        self._open_superpixels = np.flatnonzero(is_open)
        pairs = [e.superpixels.pairs + s for e, s in zip(images.values(), starts, strict=False)]
        weights = [e.pair_weight for e in images.values()]
        kinds, linked = 2, np.empty(0, np.int64)
        if volume is not None:
            kinds, linked = 3, np.unique(np.concatenate([e.link_pairs[:, 1] for e in images.values()]))
            is_open = np.concatenate([is_open, volume.is_open.reshape(-1)])
            first = np.concatenate([first, volume.first.reshape(-1)])
            pairs.append(voxel_pairs(volume.is_open) + self._superpixels)
            weights.append(np.full(len(pairs[-1]), voxel_pair_weight))
            shifts = [np.array([start, self._superpixels]) for start in starts[:-1]]
            pairs += [e.link_pairs + shift for e, shift in zip(images.values(), shifts, strict=True)]
            weights += [e.link_weight for e in images.values()]
        self._open, self._given = np.flatnonzero(is_open), first
        self._never_empty = np.searchsorted(self._open, linked + self._superpixels)
        self._folded = fold_given(
            np.concatenate(pairs, dtype=np.int32), np.concatenate(weights, dtype=np.float32), first, is_open, kinds
        )
        self.open_centres = np.empty((0, 3))
        if volume is not None:
            voxels = self._open[len(self._open_superpixels) :] - self._superpixels
            self.open_centres = voxel_places(volume.grid, voxels)
            self._sdf, self._normalised = (a.reshape(-1)[voxels] for a in (volume.sdf, volume.normalised))

    def first_labels(self) -> np.ndarray:
        return self._given[self._open]

    def split(self, labels: np.ndarray) -> dict[str, np.ndarray]:
        """Return the labels of all superpixels by keyframe."""
        found = self._given[: self._superpixels].copy()
        found[self._open_superpixels] = labels[: len(self._open_superpixels)]
        return dict(zip(self._images, np.split(found, self._starts[1:-1]), strict=True))

    def voxels(self, labels: np.ndarray) -> np.ndarray:
        """Return the labels of all voxels."""
        found = self._given[self._superpixels :].copy()
        count = len(self._open_superpixels)
        found[self._open[count:] - self._superpixels] = labels[count:]
        return found.reshape(self._volume.grid.shape)

    def connect(
        self, model: ColorModel, silhouettes: np.ndarray | None, carved: np.ndarray | None, rule: CutRule, threads: int
    ) -> LabelGraph:
        """Return the graph of Eq. 19 under the present colours, silhouettes and carving."""

        def look(evidence: ImageEvidence) -> np.ndarray:
            owner, lab, table = evidence.band
            chance = model.posterior(lab, table)
            cost = [
                mean_by(truncate(p, rule.color_cap), owner, evidence.superpixels.count) for p in (1 - chance, chance)
            ]
            both = rule.color_weight * np.stack(cost, axis=1)
            both[:, OBJECT] += rule.roi_weight * evidence.outside
            return both

        costs = list(map_ahead(look, self._images.values(), threads=threads))
        images = np.concatenate(costs)[self._open_superpixels]
        if silhouettes is not None:
            images += rule.silhouette_weight * silhouette_unary(silhouettes)[self._open_superpixels]
        if self._volume is None:
            return self._folded.with_costs(images)
        unary = np.empty((len(self._open), 3), np.float32)
        unary[: len(images), :2], unary[: len(images), EMPTY] = images, np.inf
        voxels = unary[len(images) :]
        voxels[:] = rule.sdf_weight * sdf_unary(self._sdf) + rule.scene_weight * scene_unary(self._normalised)
        if carved is not None:
            voxels[:, OBJECT] += rule.carve_weight * carved
        unary[self._never_empty, EMPTY] = np.inf
        return self._folded.with_costs(unary)


def _learn_colors(images, labels, rule, before, rng, seed, threads):
    """Learn both colour models from superpixels drawn among those that have each label at present."""
    lab = []
    for label in (OBJECT, BACKGROUND):
        owners = np.concatenate([np.full(len(own), rank) for rank, own in enumerate(labels.values())])
        numbers = np.concatenate([np.arange(len(own)) for own in labels.values()])
        among = np.flatnonzero(np.concatenate(list(labels.values())) == label)
        drawn = rng.permutation(among)[: rule.color_superpixels]
        colors = []
        for rank, evidence in enumerate(images.values()):
            chosen = np.zeros(evidence.superpixels.count, bool)
            chosen[numbers[drawn[owners[drawn] == rank]]] = True
            colors.append(evidence.image[evidence.superpixels.paint(chosen)])
        rgb = np.concatenate(colors)
        lab.append(lab_from_rgb(rgb[rng.permutation(len(rgb))[: rule.color_pixels]]))
    return fit_color_model(lab[0], lab[1], rule.components, before, seed, threads)
