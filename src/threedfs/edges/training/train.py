"""From a seed to a forest."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from threedfs.edges.forest import Forest
from threedfs.edges.training.grow import Growth, grow_tree, join_trees
from threedfs.edges.training.leaves import paint_leaves
from threedfs.edges.training.patterns import make_tiles
from threedfs.edges.training.picture import Picture
from threedfs.edges.training.renders import render_still_life
from threedfs.edges.training.samples import draw_samples

_HELD_OUT = 1 << 20  # seeds of still lifes from here on are never trained on


@dataclass(frozen=True)
class Plan:
    """How much a forest learns from.

    Attributes
    ----------
    tiles, leaves : int
        Textures, and pictures of overlapping shapes with them.
    still_lifes, views : int
        Rendered scenes, and pictures of each.
    height, width : int
        Of a picture, 4:3.
    windows : int
        Samples of each picture and tree.
    trees : int
    feature_share : float
        Of all features, that a tree may ask for.
    growth : Growth
    seed : int
    """

    tiles: int = 30
    leaves: int = 150
    still_lifes: int = 100
    views: int = 6
    height: int = 240
    width: int = 320
    windows: int = 200
    trees: int = 4
    feature_share: float = 0.2
    growth: Growth = field(default_factory=Growth)
    seed: int = 23


def make_pictures(plan: Plan, track: Callable[[Iterable, str], Iterable]) -> list[Picture]:
    """Paint and render all pictures of a plan; each has a seed of its own."""
    tiles = make_tiles(plan.tiles, np.random.default_rng([plan.seed, 0]))
    pictures = [
        paint_leaves(plan.height, plan.width, tiles, np.random.default_rng([plan.seed, 1, index]))
        for index in track(range(plan.leaves), "picture")
    ]
    for index in track(range(plan.still_lifes), "still life"):
        pictures += render_still_life(plan.views, plan.width, np.random.default_rng([plan.seed, 2, index]))
    return pictures


def held_out_renders(count: int, views: int, width: int) -> list[Picture]:
    """Render still lifes that no plan has."""
    pictures = []
    for index in range(count):
        pictures += render_still_life(views, width, np.random.default_rng([_HELD_OUT, index]))
    return pictures


def train_forest(plan: Plan, pictures: list[Picture], track: Callable[[Iterable, str], Iterable]) -> Forest:
    """Grow the trees of a plan, each on its own samples of all pictures and its own share of the features."""
    trees = []
    for index in track(range(plan.trees), "tree"):
        rng = np.random.default_rng([plan.seed, 3, index])
        samples = draw_samples(pictures, plan.windows, plan.feature_share, rng)
        trees.append(grow_tree(samples, plan.growth, rng))
    return join_trees(trees)
