"""Joint segmentation on a scene with known masks: what it finds, that its energy falls, and what it refuses."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from scene import CENTRE, PLANE, RADIUS, look, make_scene
from scipy import ndimage

from threedfs.errors import UserError
from threedfs.evaluate.masks import intersection_over_union
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.hull.gaps import fit_masks
from threedfs.locate.height import height_above
from threedfs.params.segment import SegmentParams
from threedfs.params.volumetric_cut import VolumetricCutParams
from threedfs.segment.energy import OBJECT
from threedfs.segment.gather import GatherRule, box_of_grid, gather_images, gather_voxels, picture_support
from threedfs.segment.initialise import UNDECIDED
from threedfs.segment.joint import CutRule, segment_jointly
from threedfs.segment.outline import draw_voxels
from threedfs.segment.refine import RefineRule, refine_mask
from threedfs.segment.source_mask import distort_masks
from threedfs.segment.volumetric import VolumetricRule, cut_volume
from threedfs.types import Box

DEFAULTS = SegmentParams(color_components=3, color_pixels=3000, outer_height=2.0, outer_margin=3, silhouette_ramp=2.0)


def rules(params: SegmentParams) -> tuple[GatherRule, CutRule]:
    """Return the rules of the topic from a stage's parameters."""
    named = {"random_first": params.first_labels == "random"}
    named |= {"surface_links": params.links == "surface", "components": params.color_components}
    return tuple(
        kind(**{f.name: named[f.name] if f.name in named else getattr(params, f.name) for f in fields(kind)})
        for kind in (GatherRule, CutRule)
    )


def segment(scene, params=DEFAULTS, *, alone: bool = False, threads: int = 1):
    """Return evidence of the images and the cut."""
    gather, rule = rules(params)
    rng = np.random.default_rng(0)
    volume, bounds = gather_voxels(scene, gather)
    table = picture_support(scene, bounds, gather, threads)
    images = gather_images(scene, volume, bounds, table, gather, rng, threads)
    return images, segment_jointly(images, None if alone else volume, rule, rng, threads=threads)


def overlap(masks, truth) -> float:
    """Return the mean IoU."""
    return float(np.mean([intersection_over_union(masks[name], truth[name], name) for name in truth]))


def paint(images, cut):
    """Return the masks of labelled superpixels."""
    return {name: images[name].superpixels.paint(own == OBJECT) for name, own in cut.superpixels.items()}


@pytest.fixture(scope="module")
def ball():
    """The scene, its true masks, the evidence and the cut."""
    scene, truth = make_scene()
    return scene, truth, *segment(scene)


@pytest.mark.parametrize("first_labels", ["field", "random"])
def test_no_number_of_threads_changes_the_cut(ball, first_labels):
    scene = ball[0]
    params = replace(DEFAULTS, first_labels=first_labels)
    (_, one), (_, three) = (segment(scene, params, threads=threads) for threads in (1, 3))
    assert (one.voxels == three.voxels).all()
    assert all((one.superpixels[name] == three.superpixels[name]).all() for name in one.superpixels)
    assert one.energies.tobytes() == three.energies.tobytes()


def test_ball_is_found_in_images_and_voxels(ball):
    scene, truth, images, cut = ball
    assert overlap(paint(images, cut), truth) > 0.9
    solid = (scene.sdf < 0) & (height_above(PLANE, scene.located.grid) > 2 * scene.located.grid.spacing)
    found = (cut.voxels == OBJECT) & (height_above(PLANE, scene.located.grid) > 2 * scene.located.grid.spacing)
    assert (solid & found).sum() > 0.95 * (solid | found).sum()


def test_pixels_are_nearer_to_the_truth_than_superpixels(ball):
    _, truth, images, cut = ball
    rule = RefineRule(5.0, 1.0, 0.5, 0.0, 1.5, 8.0)
    finer = {name: refine_mask(images[name], own, cut.colors, None, rule) for name, own in cut.superpixels.items()}
    assert overlap(finer, truth) > max(0.96, overlap(paint(images, cut), truth))


def test_energy_falls_within_each_round_and_is_reported_for_each_move(ball):
    *_, cut = ball
    assert len(cut.energies) == len(cut.swaps) and len(cut.energies) % 3 == 0
    rounds = cut.energies.reshape(-1, 3)
    assert (np.diff(rounds, axis=1) <= 1e-4 * np.abs(rounds[:, :1])).all()


def test_colours_bring_back_what_the_field_lost():
    scene, truth = make_scene(shrink=0.03)
    images, cut = segment(scene)
    field = {name: e.superpixels.paint(e.first == OBJECT) for name, e in images.items()}
    assert overlap(paint(images, cut), truth) > overlap(field, truth) + 0.05


def test_images_alone_are_cut_by_colour():
    scene, truth = make_scene()
    images, cut = segment(scene, alone=True)
    assert cut.voxels is None and len(cut.energies) % 2 == 0
    assert overlap(paint(images, cut), truth) > 0.88


def test_printed_version_runs_and_finds_the_ball():
    printed = replace(
        DEFAULTS,
        outer_height=0.0,
        outer_margin=0,
        fill_outer=False,
        inner_level=-0.5,
        first_labels="random",
        deepest=0.3,
        table=False,
        roi_weight=10.0,
        silhouette_weight=1.0,
        silhouette_ramp=0.0,
        carve_tolerance=0.0,
        pair_weight=1.0,
        pair_edge="sum",
        links="semidense",
        link_weight=1.0,
        link_by_share=False,
        stop_share=0.0,
    )
    scene, truth = make_scene()
    images, cut = segment(scene, printed)
    assert overlap(paint(images, cut), truth) > 0.75


def test_first_carving_by_a_cut_keeps_what_random_masks_carve():
    """After one round from random labels: masks of the labels carve most of the ball, those of a cut little."""
    scene, _ = make_scene()
    once = replace(DEFAULTS, first_labels="random", carve_tolerance=0.0, iterations=1, pair_edge="sum")
    kept = {}
    for choice in ("first_labels", "cut", "none"):
        _, cut = segment(scene, replace(once, first_carving=choice))
        kept[choice] = int((cut.voxels == OBJECT).sum())
    assert kept["first_labels"] < 0.7 * kept["cut"] <= 0.7 * kept["none"]


def test_region_is_the_box_or_all_of_the_grid():
    """The grid holds what the box cuts off: less lies outside of it, and nothing inside the box does."""
    scene, _ = make_scene()
    small = replace(scene, box=Box(scene.box.axes, scene.box.low * 0.3, scene.box.high * 0.3))
    shares = {}
    for choice in ("box", "grid"):
        gather, _ = rules(replace(DEFAULTS, roi=choice))
        volume, bounds = gather_voxels(small, gather)
        images = gather_images(small, volume, bounds, None, gather, np.random.default_rng(0))
        shares[choice] = np.concatenate([evidence.outside for evidence in images.values()])
    assert (shares["grid"] <= shares["box"]).all() and shares["grid"].sum() < shares["box"].sum()


def test_the_box_of_a_grid_holds_its_voxels_to_their_faces():
    grid = cover_box(Box(np.eye(3)[[1, 2, 0]], np.array([-1.0, 2.0, 0.5]), np.array([1.0, 3.0, 1.0])), 8)
    box = box_of_grid(grid)
    assert box.low == pytest.approx([-1, 2, 0.5]) and box.high == pytest.approx([1, 3, 1])


def test_under_estimate_of_all_pieces_holds_more_than_the_object():
    scene, _ = make_scene()
    alone = replace(scene, located=replace(scene.located, voxels=scene.located.voxels & (scene.sdf < -0.9)))
    inner = {}
    for choice in ("object", "outer"):
        gather, _ = rules(replace(DEFAULTS, inner_level=-0.5, inner_pieces=choice))
        inner[choice] = gather_voxels(alone, gather)[1].inner
    assert not (inner["object"] & ~inner["outer"]).any() and inner["outer"].sum() > inner["object"].sum()


def test_same_seed_same_labels(ball):
    scene, _, _, cut = ball
    _, again = segment(scene)
    assert np.array_equal(again.voxels, cut.voxels) and np.array_equal(again.energies, cut.energies)


def test_nothing_open_is_refused():
    scene, _ = make_scene(views=4)
    closed = replace(DEFAULTS, outer_margin=0, outer_level=-0.9, inner_level=0.9, decided_share=0.5, fill_outer=False)
    with pytest.raises(UserError, match="between the outer and the inner"):
        segment(scene, closed)


def test_an_object_that_loses_all_its_voxels_is_refused():
    scene, _ = make_scene(views=4)
    repelled = replace(
        DEFAULTS, scene_weight=-50.0, deepest=0.5, silhouette_weight=0.0, link_weight=0.0, stop_share=0.0
    )
    with pytest.raises(UserError, match="found none left"):
        segment(scene, repelled)


def test_keyframes_without_links_are_named():
    scene, _ = make_scene(views=4)
    gather, rule = rules(DEFAULTS)
    rng = np.random.default_rng(0)
    volume, bounds = gather_voxels(scene, gather)
    images = gather_images(scene, volume, bounds, picture_support(scene, bounds, gather), gather, rng)
    bare = {name: replace(e, link_pairs=e.link_pairs[:0], link_weight=e.link_weight[:0]) for name, e in images.items()}
    first = next(iter(images))
    notes = []
    segment_jointly({**images, first: bare[first]}, volume, rule, rng, notes.append)
    assert notes[0].startswith(f"1 of 4 keyframes have no link with voxels, {first}: ")
    segment_jointly(images, volume, rule, rng, notes.append)
    segment_jointly(bare, None, rule, rng, notes.append)  # images alone need none
    assert not any("no link" in note for note in notes[1:])


def test_masks_carve_and_fill_a_field():
    scene, truth = make_scene(views=12)
    centres, height = voxel_centres(scene.located.grid), height_above(PLANE, scene.located.grid)
    ball = (np.linalg.norm(centres - CENTRE, axis=-1) < RADIUS) & (height > 0)
    wrong = scene.sdf.copy()
    wrong[(centres[..., 0] > 0.1) & (height > 0)] = 1  # a side is lost
    lump = (np.linalg.norm(centres - (-0.22, 0.0, 0.2), axis=-1) < 0.06) & (height > 0)
    wrong[lump] = -1
    fitted, filled = fit_masks(
        wrong,
        (wrong < 0) & (height > 0),
        height > 0,
        truth,
        scene.views,
        scene.valid,
        scene.located.grid,
        ramp=5,
        tolerance=0,
        least_views=2,
    )
    before, after = ((field < 0) & (height > 0.02) for field in (wrong, fitted))
    wanted = ball & (height > 0.02)
    assert (before & wanted).sum() / (before | wanted).sum() < 0.85
    assert (after & wanted).sum() / (after | wanted).sum() > 0.9
    assert filled.any() and (fitted[filled] < 0).all()
    assert not (after & lump & ~ball)[np.linalg.norm(centres - CENTRE, axis=-1) > RADIUS + 0.04].any()


def test_a_rim_of_the_masks_raises_no_peak_over_a_flat_object():
    """Views from above leave a roof of the hull over a slab; masks a little wide call for a rim, not for that roof."""
    scene, _ = make_scene(views=12)
    centres, height = voxel_centres(scene.located.grid), height_above(PLANE, scene.located.grid)
    slab = np.minimum(0.2 - np.abs(centres[..., :2]).max(-1), 0.06 - height) / (4 * scene.located.grid.spacing)
    sdf = np.clip(-slab, -1, 1).astype(np.float32)
    solid = (sdf < 0) & (height > 0)
    drawn = draw_voxels(solid, scene.located.grid, scene.views)
    wide = {name: ndimage.binary_dilation(mask, iterations=2) for name, mask in drawn.items()}
    fitted, filled = fit_masks(
        sdf, solid, height > 0, wide, scene.views, scene.valid, scene.located.grid, ramp=5, tolerance=0.1, least_views=2
    )
    assert filled.any() and (fitted[filled] < 0).all()
    assert height[filled].max() < 0.06 + 4 * scene.located.grid.spacing


def test_masks_that_fit_leave_a_field_alone():
    scene, truth = make_scene(views=12)
    height = height_above(PLANE, scene.located.grid)
    solid = (scene.sdf < 0) & (height > 0)
    wide = {name: ndimage.binary_dilation(mask, iterations=2) for name, mask in truth.items()}
    fitted, _ = fit_masks(
        scene.sdf,
        solid,
        height > 0,
        wide,
        scene.views,
        scene.valid,
        scene.located.grid,
        ramp=5,
        tolerance=0,
        least_views=99,
    )
    assert np.array_equal((fitted < 0) & (height > 0), solid)


def test_border_of_an_undistorted_image_is_no_outline():
    """Images that end within the object: where nothing is seen, no mask carves."""
    scene, truth = make_scene(views=12)
    height = height_above(PLANE, scene.located.grid)
    solid = (scene.sdf < 0) & (height > 0)
    valid = {name: shown.copy() for name, shown in scene.valid.items()}
    for shown in valid.values():
        shown[:, : shown.shape[1] // 2] = False
    cropped = {name: mask & valid[name] for name, mask in truth.items()}
    settings = {"ramp": 5, "tolerance": 0, "least_views": 99}
    whole, _ = fit_masks(scene.sdf, solid, height > 0, truth, scene.views, scene.valid, scene.located.grid, **settings)
    half, _ = fit_masks(scene.sdf, solid, height > 0, cropped, scene.views, valid, scene.located.grid, **settings)
    assert ((half < 0) & solid).sum() >= ((whole < 0) & solid).sum() > 0


def test_links_tie_decided_superpixels_too_and_none_have_no_weight():
    scene, _ = make_scene()
    rule, _ = rules(replace(DEFAULTS, inner_level=-0.5))
    for links in (True, False):
        volume, bounds = gather_voxels(scene, replace(rule, surface_links=links))
        images = gather_images(
            scene, volume, bounds, None, replace(rule, surface_links=links), np.random.default_rng(0)
        )
        linked = np.concatenate([evidence.decided[evidence.link_pairs[:, 0]] for evidence in images.values()])
        assert (linked == UNDECIDED).any() and (linked != UNDECIDED).any()
        images = gather_images(scene, volume, bounds, None, replace(rule, link_weight=0.0), np.random.default_rng(0))
        assert all(len(evidence.link_pairs) == 0 for evidence in images.values())


def test_voxels_alone_are_cut_by_colour():
    scene, _ = make_scene()
    params = VolumetricCutParams(components=3, color_pixels=3000)
    rule = VolumetricRule(**{f.name: getattr(params, f.name) for f in fields(VolumetricRule)})
    height = height_above(PLANE, scene.located.grid)
    votes = np.zeros(scene.located.grid.shape, np.float32)
    rng = np.random.default_rng(0)
    voxels = cut_volume(scene.images, scene.views, scene.located.grid, height, votes, CENTRE, rule, rng)
    solid = np.clip(scene.sdf, -1, 1) < 0
    found, high = voxels == OBJECT, height > 0.05
    assert (solid & found & high).sum() > 0.75 * ((solid | found) & high).sum()


def test_mask_goes_to_the_source_frame():
    view = look(0.3)
    mask = np.zeros(view.camera.shape, bool)
    mask[20:60, 30:80] = True

    def distort(distortion, shape):
        return dict(distort_masks({"own": mask}, {"own": view}, {"own": view}, distortion, shape))["own"]

    twice = distort((0.0, 0.0), (180, 240))
    assert twice.shape == (180, 240) and np.array_equal(twice[1::2, 1::2][:, :], mask)
    bent = distort((0.8, 0.0), view.camera.shape)
    assert 0 < (bent ^ mask).sum() < 0.2 * mask.sum()
