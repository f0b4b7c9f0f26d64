"""Contract, property and rejection: the stage spectral_matting on a ball on a table, seen from around."""

from __future__ import annotations

import io
from dataclasses import asdict, replace

import numpy as np
import pytest
from scene import make_scene

from threedfs.errors import UserError
from threedfs.evaluate.masks import intersection_over_union
from threedfs.io.crops import Crop, write_crops
from threedfs.io.keyframes import write_keyframes
from threedfs.io.located import write_located
from threedfs.io.segmentation import read_segmentation
from threedfs.io.volumes import Volume, write_volume
from threedfs.job import Job
from threedfs.matting.components import ComponentRule
from threedfs.matting.spectral import SpectralRule, matte_image
from threedfs.matting.trimap import BoundsRule, Trimap, draw_trimaps
from threedfs.params.segment import SegmentParams
from threedfs.params.spectral_matting import SpectralMattingParams
from threedfs.progress import Progress
from threedfs.stages import spectral_matting
from threedfs.types import Keyframe

BOUNDS = asdict(SegmentParams(outer_height=2.0, outer_margin=3))
DEFAULTS = SpectralMattingParams(pixels=3000, eigenvectors=20, components=8, iterations=5)


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    """A folder with what the stage reads of four keyframes, and the true masks."""
    folder, (scene, truth) = tmp_path_factory.mktemp("ball"), make_scene(views=4)
    write_volume(folder / "field", Volume(scene.located.grid, scene.sdf, np.ones_like(scene.sdf, np.uint8)), {})
    write_located(folder / "located", scene.located, {})
    write_keyframes(folder / "keyframes", [Keyframe(view, (), 0.5, 2.0) for view in scene.views.values()], {})
    crops = [Crop(name, image, scene.valid[name]) for name, image in scene.images.items()]
    write_crops(folder / "crops", crops, {}, ordered=True, source_shape=(90, 120))
    return folder, scene, truth


def matte(folder, params=DEFAULTS, bounds=BOUNDS, out="labels", log=None):
    """Run the stage; return what it wrote."""
    spectral_matting.run(
        **{name: folder / name for name in ("field", "located", "keyframes", "crops")},
        labels=folder / out,
        segmentation=bounds,
        params=params,
        job=Job(Progress("spectral_matting", log or io.StringIO()), {"provenance": "test"}),
    )
    return read_segmentation(folder / out)


def test_the_ball_is_found_in_every_keyframe_and_again_in_the_same_bytes(ball):
    folder, _, truth = ball
    found = matte(folder)
    assert found.voxels.size == 0 and len(found.energies) == len(found.swaps) == 0
    overlap = {name: intersection_over_union(found.masks[name], truth[name], name) for name in truth}
    assert min(overlap.values()) > 0.9
    first = (folder / "labels").read_bytes()
    matte(folder)
    assert (folder / "labels").read_bytes() == first


@pytest.mark.parametrize(
    "change",
    [
        {"pixels": 1000},
        {"epsilon": 0.1},
        {"eigenvectors": 6},
        {"components": 3},
        {"sparsity": 0.3},
        {"iterations": 0},
        {"inner_level": -0.9},
    ],
)
def test_each_parameter_acts(ball, change):
    """Contract: the opacities are others."""
    _, scene, _ = ball

    def opacities(params):
        rule = ComponentRule(params.eigenvectors, params.components, params.sparsity, params.iterations)
        bounds = BoundsRule(0.5, 2.0, 3, True, params.inner_level)
        trimaps = draw_trimaps(scene.located, scene.sdf, scene.views, scene.valid, bounds)
        how = SpectralRule(params.pixels, params.epsilon, rule)
        name = next(iter(scene.views))
        return matte_image(scene.images[name], trimaps[name], how, np.random.default_rng(0))

    assert not np.array_equal(opacities(DEFAULTS), opacities(replace(DEFAULTS, **change)))


def test_the_bounds_of_the_segmentation_act(ball):
    folder, scene, _ = ball
    wide = matte(folder, bounds=BOUNDS | {"outer_margin": 12, "outer_level": 0.9}, out="wide")
    tight = matte(folder, bounds=BOUNDS | {"outer_margin": 0, "outer_level": -0.4}, out="tight")
    assert sum(mask.sum() for mask in tight.masks.values()) < sum(mask.sum() for mask in wide.masks.values())
    hidden = dict.fromkeys(scene.views, np.zeros((90, 120), bool))
    rule = BoundsRule(0.5, 2.0, 3, True, -0.5)
    assert not any(t.outer.any() for t in draw_trimaps(scene.located, scene.sdf, scene.views, hidden, rule).values())


def test_what_the_trimap_knows_stays(ball):
    _, scene, _ = ball
    rule = SpectralRule(2000, 1e-6, ComponentRule(10, 5, 0.9, 3))
    trimaps = draw_trimaps(scene.located, scene.sdf, scene.views, scene.valid, BoundsRule(0.5, 2.0, 3, True, -0.5))
    for name, trimap in trimaps.items():
        found = matte_image(scene.images[name], trimap, rule, np.random.default_rng(0))
        assert found.min() >= 0 and found.max() <= 1
        assert (found[trimap.inner] == 1).all() and (found[~trimap.outer] == 0).all()


@pytest.mark.parametrize("outer", [False, True])
def test_an_image_without_a_known_object_has_none(ball, outer):
    """Exact: there is nothing to tell by which components are the object's."""
    image = next(iter(ball[1].images.values()))
    nothing = np.zeros(image.shape[:2], bool)
    around = nothing.copy()
    around[20:40, 20:40] = outer
    rule = SpectralRule(2000, 1e-6, ComponentRule(10, 5, 0.9, 3))
    assert not matte_image(image, Trimap(nothing, around), rule, np.random.default_rng(0)).any()


def test_a_field_that_knows_nothing_for_certain_is_refused(ball, tmp_path):
    folder, _, _ = ball
    with pytest.raises(UserError, match=r"below -1 .*raise spectral_matting.inner_level"):
        matte(folder, replace(DEFAULTS, inner_level=-1.0), out="refused")
    assert not (folder / "refused").exists()
