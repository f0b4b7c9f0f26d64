"""Contract: the stage surface on a sphere on a table, some of whose depth is wrong and not confirmed."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import trimesh
from sklearn.mixture import GaussianMixture

from threedfs.errors import UserError
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.similarity import Similarity
from threedfs.io.appearance import write_appearance
from threedfs.io.consistency import ConsistencyMap, write_consistency
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import DepthMap, write_depth_map
from threedfs.io.images import read_mask
from threedfs.io.keyframes import write_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.poses import Poses, write_poses
from threedfs.io.segmentation import Segmentation, read_segmentation, write_segmentation
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.object.silhouettes import draw_silhouette
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.segment import SegmentParams
from threedfs.params.surface import SurfaceParams
from threedfs.progress import Progress
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import ColorModel, lab_from_rgb
from threedfs.segment.mixture import Mixture
from threedfs.stages import surface
from threedfs.surface import outline, shape
from threedfs.types import Box, Keyframe, Plane, Support, VoxelGrid

SIDE = 44
BEHIND = 1.12
"""Depth in a pit over the true depth."""
LITTLE_BEHIND = 1.008
"""The same of views that may adopt what others have found."""
FAR_BEHIND = 1.6
"""The same where a side is lost: depth of what lies beyond it."""


RED, GREY = (190, 40, 30), (120, 120, 125)


def photograph(shown):
    """Return the sphere in red on grey, with noise."""
    noise = np.random.default_rng(3).normal(0, 6, (*shown.shape, 3))
    return np.clip(np.where(shown[..., None], RED, GREY) + noise, 0, 255).astype(np.uint8)


def learn_colors():
    """Return the appearance that a segmentation would have learnt."""
    rng = np.random.default_rng(5)

    def fit(color):
        rgb = np.clip(rng.normal(color, 6, (500, 3)), 0, 255).astype(np.uint8)
        found = GaussianMixture(2, reg_covar=1.0, random_state=0).fit(lab_from_rgb(rgb).astype(np.float64))
        return Mixture(found.weights_, found.means_, found.precisions_cholesky_)

    return Appearance(ColorModel(fit(RED), fit(GREY)), None)


def shows_sphere(table, view, depth):
    points = backproject_map(view, depth)
    return np.linalg.norm(points - table.centre, axis=-1) < table.radius + 1e-6


def write_scene(folder, table, *, pit=False, lost=False, lent=False, empty=False, contradicted=0):
    """Write what the stage reads.

    With a pit, one side of the sphere is bare, and its depth too far away; with that side lost, all views agree on it.
    With depth that is lent there, every third view is right. So many views may have a surface before it.
    """
    views, maps, masks, photos = table.views, {}, {}, {}
    behind = FAR_BEHIND if lost else LITTLE_BEHIND if lent else BEHIND
    for rank, view in enumerate(views):
        depth = table.depth(view)
        masks[view.name] = shows_sphere(table, view, depth) & (not empty)
        photos[view.name] = photograph(shows_sphere(table, view, depth))
        points = backproject_map(view, depth)
        bare = (
            masks[view.name]
            & (points[..., 0] > table.centre[0] + 0.4 * table.radius)
            & (pit or lost or (lent and rank % 3 > 0))
        )
        depth = np.where(bare, behind * depth, depth).astype(np.float32)
        photometric = np.where(bare, 0.0, 0.3).astype(np.float32)
        write_depth_map(folder / "depth" / f"{view.name}.zarr.zip", DepthMap(depth, 0 * photometric, photometric), {})
        agree = np.where(bare & (pit or lent), 1 + rank % 2, 9).astype(np.uint8)
        silent, free = np.zeros_like(agree), np.zeros(agree.shape, np.float32)
        too_far = np.where(bare, contradicted, 0).astype(np.uint8)
        share = np.where(bare & (pit or lent), 0.7, 1.0).astype(np.float32)
        maps[view.name] = ConsistencyMap(
            confidence=share, agree=agree, too_near=silent, too_far=too_far, free_depth=free
        )
    write_consistency(folder / "consistency.zarr.zip", maps.items(), {})
    write_keyframes(folder / "keyframes.json", [Keyframe(view, (), 0.5, 3.0) for view in views], {}, object_pixels=80.0)
    spacing = 2.6 * table.radius / SIDE
    grid = VoxelGrid(table.centre - 1.3 * table.radius, spacing, (SIDE + 1,) * 3)
    nothing = np.zeros(0)
    cut = Segmentation(masks, grid, np.ones(grid.shape, np.uint8), nothing, nothing.astype(np.int64))
    write_segmentation(folder / "labels.zarr.zip", cut, {})
    box = Box(np.eye(3), table.centre - 1.3 * table.radius, table.centre + 1.3 * table.radius)
    figures = {"thickness": 2 * table.radius}
    write_support(folder / "support.json", Support(Plane(np.array([0.0, 0.0, 1.0]), 0.0), box, figures), {})
    same = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(folder / "poses.json", Poses(tuple(views), (), (0.0, 0.0), same), {})
    write_appearance(folder / "appearance.zarr.zip", learn_colors(), {})
    crops = [Crop(view.name, photos[view.name], np.ones(view.camera.shape, bool)) for view in views]
    write_crops(folder / "crops.zarr.zip", crops, {}, ordered=True, source_shape=views[0].camera.shape)


def work(folder, **changes):
    """Run the stage; return the mesh, and the bytes that it wrote."""
    fusion = FuseObjectParams(clip_distance=5.0)
    surface.run(
        labels=folder / "labels.zarr.zip",
        appearance=folder / "appearance.zarr.zip",
        keyframes=folder / "keyframes.json",
        depth=sorted((folder / "depth").iterdir()),
        consistency=folder / "consistency.zarr.zip",
        support=folder / "support.json",
        poses=folder / "poses.json",
        crops=folder / "crops.zarr.zip",
        mesh=folder / "mesh.ply",
        silhouettes=folder / "silhouettes.zarr.zip",
        masks=folder / "masks",
        method="surface",
        fusion=vars(fusion),
        segmentation=vars(SegmentParams()),
        params=SurfaceParams(**({"longest_side": SIDE} | changes)),
        job=Job(Progress("test"), {"provenance": "test"}),
    )
    mesh = trimesh.load(folder / "mesh.ply", process=True)
    return mesh, [path.read_bytes() for path in (folder / "mesh.ply", folder / "silhouettes.zarr.zip")]


@pytest.fixture(scope="module")
def right(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("right")
    write_scene(folder, table)
    return folder


@pytest.fixture(scope="module")
def pitted(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pitted")
    write_scene(folder, table, pit=True)
    return folder


def deepest(mesh, table):
    """Return how far the surface over the foot reaches into the sphere, in radii."""
    upper = mesh.vertices[mesh.vertices[:, 2] > 0.6 * table.radius]
    return 1 - np.linalg.norm(upper - table.centre, axis=1).min() / table.radius


def test_right_depth_gives_the_sphere(right, table):
    mesh, _ = work(right)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
    assert deepest(mesh, table) < 0.06
    for view in table.views:
        drawn = read_mask(right / "masks" / f"{view.name}.png")
        shown = shows_sphere(table, view, table.depth(view))
        assert (drawn & shown).sum() / (drawn | shown).sum() > 0.94


def test_depth_that_nothing_confirms_carves_no_pit(pitted, table):
    """Property: the hull closes what wrong depth opens; with all depth believed the pit is there."""
    closed = deepest(work(pitted, matched_reach=0.01)[0], table)
    believed = deepest(
        work(pitted, agree_from=0.0, agree_full=1.0, hull_trust=0.0, sure_hull_trust=0.0, gap_views=99)[0], table
    )
    assert closed < 0.1 < 0.2 < believed


def test_the_same_bytes_twice(pitted):
    assert work(pitted)[1] == work(pitted)[1]


@pytest.mark.parametrize(
    "change",
    [
        {"longest_side": 50},
        {"agree_from": 0.0},
        {"agree_full": 20.0, "matched_full": 1.0},
        {"matched": 1.0},
        {"bare_matched": 1.0},
        {"matched_from": 0.0, "matched_reach": 0.3},
        {"matched_full": 1.0},
        {"matched_reach": 0.3},
        {"hull_trust": 0.9},
        {"bound_tolerance": 0.0},
        {"gap_tolerance": 0.0},
        {"free_share": 1.0},
        {"stiffness": 0.0},
        {"closing": 0.0},
        {"medians": 0},
        {"sure_from": 0.0},
        {"sure_full": 0.65},
        {"free_contradicted": 0.0},
        {"free_from": 0.0},
        {"free_full": 1.0},
        {"aslant_agree_from": 0.0},
        {"aslant_agree_full": 90.0},
        {"aslant_from": 0.0},
        {"aslant_full": 1.0},
        {"mirrored_height": 0.9},
        {"sure_hull_trust": 0.9},
        {"sure_clip_share": 0.9},
        {"gap_views": 99},
        {"gap_share": 1.0},
        {"smoothing_steps": 0},
        {"smoothing_contrast": 5.0},
        {"outline_ramp": 0.25},
        {"bare_tolerance": 0.4},
    ],
    ids=str,
)
def test_every_parameter_acts(pitted, change):
    """Contract: of an object that is not round, or the hull alone would shape it."""
    base = {"round_full": 0.0, "round_until": 0.0}
    assert work(pitted, **(base | change))[1][0] != work(pitted, **base)[1][0]


@pytest.mark.parametrize("change", [{"free_textured": 1.0}, {"textured_from": 0.85}, {"textured_full": 0.55}], ids=str)
def test_what_textured_things_are_believed_acts(table, tmp_path, change):
    """Contract: where photographs around a pit match, and four of twelve keyframes contradict it."""
    write_scene(tmp_path, table, pit=True, contradicted=4)
    base = {"free_textured": 4.0, "textured_from": 0.5, "textured_full": 0.9, "matched_reach": 0.3, "sure_full": 0.3}
    assert work(tmp_path, **(base | change))[1][0] != work(tmp_path, **base)[1][0]


@pytest.mark.parametrize(
    "change",
    [
        {"hollow_depth": 0.5},
        {"hollow_agree": 1.0},
        {"round_full": 0.45},
        {"round_until": 0.9},
        {"round_trust": 0.2},
        {"hull_tolerance": 0.4},
    ],
    ids=str,
)
def test_what_tells_of_hollows_acts(pitted, change):
    """Contract: a bare object whose depth, hardly agreed on, lies deep inside of its outline."""
    base = {"sure_from": 0.98, "sure_full": 0.99, "matched_reach": 0.3, "hollow_agree": 2.0, "round_full": 0.1}
    base |= {"round_until": 0.7, "hollow_depth": 0.05, "round_trust": 1.0, "frames": 0}
    assert work(pitted, **(base | change))[1][0] != work(pitted, **base)[1][0]


@pytest.fixture(scope="module")
def lending(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("lending")
    write_scene(folder, table, lent=True)
    return folder


@pytest.mark.parametrize(
    "change",
    [
        {"lent_from": 10.0},
        {"adopted_within": 0.001},
        {"adopted_reach": 0.1},
        {"adopted_full": 0.0, "adopted_until": 0.0},
        {"adopted_until": 0.4},
    ],
    ids=str,
)
def test_every_parameter_of_what_is_adopted_acts(lending, change):
    assert work(lending, frames=0, **change)[1][0] != work(lending, frames=0)[1][0]


def test_a_bare_side_is_where_others_have_found_it(lending, table):
    """Property: with all depth believed, what is adopted takes most of the error of the side's depth away."""
    found = []
    for change in ({}, {"adopted_full": 0.0, "adopted_until": 0.0}):
        believed = {"agree_from": 0.0, "agree_full": 1.0, "hull_trust": 0.0, "sure_hull_trust": 0.0, "frames": 0}
        mesh, _ = work(lending, **believed, **change)
        beside = mesh.vertices[mesh.vertices[:, 0] > table.centre[0] + 0.5 * table.radius]
        found.append(np.median(1 - np.linalg.norm(beside - table.centre, axis=1) / table.radius))
    assert found[0] < 0.5 * found[1]


def test_without_masks_it_is_refused(table, tmp_path):
    write_scene(tmp_path, table, empty=True)
    with pytest.raises(UserError, match="masks of the object in the keyframes, found them all empty"):
        work(tmp_path)
    assert not (tmp_path / "mesh.ply").exists()


def overlap(masks, table):
    """Return the mean IoU of masks, in the order of the views, with those of the sphere."""
    exact = [shows_sphere(table, view, table.depth(view)) for view in table.views]
    return np.mean([(mask & shown).sum() / (mask | shown).sum() for mask, shown in zip(masks, exact, strict=True)])


def agreement(folder, table):
    """Return the mean IoU of the mesh's outlines with those of the sphere."""
    mesh = read_mesh(folder / "mesh.ply")
    return overlap([draw_silhouette(mesh, view) for view in table.views], table)


def test_masks_are_cut_around_the_surface(table, tmp_path):
    """Property: around a surface that is too small, masks follow colours, as far as they may."""
    write_scene(tmp_path, table)
    cut = read_segmentation(tmp_path / "labels.zarr.zip")
    thin = {name: cv2.erode(mask.astype(np.uint8), np.ones((9, 9))) > 0 for name, mask in cut.masks.items()}
    write_segmentation(tmp_path / "labels.zarr.zip", replace(cut, masks=thin), {})
    found = []
    for ramp in (0.1, 6.0):
        work(tmp_path, frames=0, outline_weight=1.0, mask_ramp=ramp)
        masks = [read_mask(tmp_path / "masks" / f"{view.name}.png") for view in table.views]
        found.append(overlap(masks, table))
    assert agreement(tmp_path, table) < found[0] < found[1] - 0.02 and found[1] > 0.99


def test_depth_holds_what_some_masks_lack(table, tmp_path):
    """Property: a part that five masks of twelve lack stays, where all depth has its surface and it is high enough."""
    write_scene(tmp_path, table)
    cut = read_segmentation(tmp_path / "labels.zarr.zip")
    masks = {
        name: mask & ((np.cumsum(mask.any(axis=1)) > 20)[:, None] | (rank % 2 == 0) | (rank > 9))
        for rank, (name, mask) in enumerate(cut.masks.items())
    }
    write_segmentation(tmp_path / "labels.zarr.zip", replace(cut, masks=masks), {})
    given = {"frames": 0, "gap_views": 99}
    held, cut_off, low = (
        work(tmp_path, **given, **change)[0].bounds[1, 2] for change in ({}, {"held_share": 0.0}, {"held_height": 90.0})
    )
    assert cut_off + 0.25 * table.radius < held < table.centre[2] + 1.05 * table.radius and low == cut_off


def test_what_masks_show_and_no_depth_has_is_filled(table, tmp_path):
    """Property: a side of the sphere on which all depth is wrong is there again, as its outline says."""
    write_scene(tmp_path, table, lost=True)
    volumes, ious = [], []
    for change in ({"gap_views": 99}, {}):
        mesh, _ = work(tmp_path, hull_trust=0.0, sure_hull_trust=0.0, **change)
        volumes.append(mesh.volume)
        ious.append(agreement(tmp_path, table))
    assert ious[0] < 0.8 and ious[1] > 0.93
    assert volumes[0] < 0.7 * volumes[1]


def test_what_a_mask_shows_outside_is_filled_only_against_the_odds(table, tmp_path):
    """Property: a lost side that eleven masks show and one does not is filled, unless fifty must outnumber it."""
    write_scene(tmp_path, table, lost=True)
    cut = read_segmentation(tmp_path / "labels.zarr.zip")
    name = next(iter(cut.masks))
    half = cut.masks[name] & (np.cumsum(cut.masks[name], axis=1) * 2 < cut.masks[name].sum(axis=1, keepdims=True))
    write_segmentation(tmp_path / "labels.zarr.zip", replace(cut, masks={**cut.masks, name: half}), {})
    given = {"frames": 0, "hull_trust": 0.0, "sure_hull_trust": 0.0}
    volumes = [work(tmp_path, gap_odds=odds, **given)[0].volume for odds in (2.0, 50.0)]
    assert volumes[1] < 0.9 * volumes[0]


def test_masks_that_contradict_each_other_are_refused(table, tmp_path):
    """Each view shows the object at another side of the sphere, so that no place is inside of all masks."""
    write_scene(tmp_path, table)
    cut = read_segmentation(tmp_path / "labels.zarr.zip")
    corner = np.zeros(next(iter(cut.masks.values())).shape, bool)
    masks = {}
    for rank, name in enumerate(sorted(cut.masks)):
        masks[name] = corner.copy()
        masks[name][(slice(0, 6), slice(-6, None))[rank % 2], (slice(0, 6), slice(-6, None))[rank // 2 % 2]] = True
    write_segmentation(tmp_path / "labels.zarr.zip", replace(cut, masks=masks), {})
    with pytest.raises(UserError, match="masks that agree on where the object is"):
        work(tmp_path, bound_tolerance=0.0, gap_tolerance=0.0)
    assert not (tmp_path / "mesh.ply").exists()


def test_masks_by_the_surface_so_far_mend_those_of_the_segmentation(table, tmp_path):
    """Property: masks that lack a strip make the surface too small; colours near its outline bring it back."""
    write_scene(tmp_path, table)
    cut = read_segmentation(tmp_path / "labels.zarr.zip")
    thin = {name: cv2.erode(mask.astype(np.uint8), np.ones((5, 5))) > 0 for name, mask in cut.masks.items()}
    write_segmentation(tmp_path / "labels.zarr.zip", replace(cut, masks=thin), {})
    found, meshes = [], []
    for change in ({"frames": 0}, {"outline_weight": 1.0}, {"outline_weight": 200.0}):
        meshes.append(work(tmp_path, **change)[1][0])
        found.append(agreement(tmp_path, table))
    assert found[1] > found[0] + 0.02 and found[1] > found[2]
    assert len(set(meshes)) == 3


def test_where_the_second_masks_are_empty_the_first_surface_stays(right, table, monkeypatch):
    """Property: masks by the surface so far that show nothing do not make everything solid."""
    first = work(right, frames=0)[1][0]
    monkeypatch.setattr(outline, "mask_frame", lambda view, *_: np.zeros(view.camera.shape, bool))
    assert work(right)[1][0] == first


def test_tunnels_up_to_the_width_are_closed(right, monkeypatch):
    """Exact: a shaft three voxels wide through the fused sphere makes a handle, unless it is closed by either rule."""
    shaped = shape.complete_depth

    def pierce(*arguments):
        field = shaped(*arguments)
        middle = field.shape[0] // 2
        field[middle - 1 : middle + 2, :, field.shape[2] // 2 - 1 : field.shape[2] // 2 + 2] = 1
        return field

    monkeypatch.setattr(shape, "complete_depth", pierce)
    given = {"frames": 0, "free_share": 0.0, "closing": 0.0, "stiffness": 0.0}
    widths = ((0.0, 0.0), (4.0, 0.0), (0.0, 4.0))
    genus = [
        1 - work(right, tunnel_width=width, hidden_tunnel_width=hidden, **given)[0].euler_number // 2
        for width, hidden in widths
    ]
    assert genus == [1, 0, 0]
