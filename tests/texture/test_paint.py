"""Property: a ball painted from photographs looks as the ball does, from where it was not photographed."""

import numpy as np
import pytest
from painted_ball import WALL, ball, everywhere, look_from, photograph, ring

import threedfs.texture.bake as bake
import threedfs.texture.paint as paint
from threedfs.evaluate.photo_error import measure_photo
from threedfs.texture.photograph import photograph_texture

RULE = paint.PaintRule(seam_cost=0.5, texels=1.0)
ELSEWHERE = look_from(0.3, 0.5)
MESH = ball(4)


def paint_from(images, rule=RULE, valid=everywhere, mesh=MESH):
    return paint.paint_mesh(mesh, ring(8), images.__getitem__, valid, rule)


def fidelity(painting):
    """Return the PSNR in dB of the painting from where no photograph was taken, after one gain and offset."""
    picture, shown = photograph_texture(painting.textured).take(ELSEWHERE)
    return measure_photo(picture, photograph(ball(5), ELSEWHERE), shown)[0]


@pytest.fixture(scope="module")
def painting(photos):
    return paint_from(photos)


@pytest.fixture
def exposed(photos):
    """The photographs, each of an exposure of its own."""
    gains = np.random.default_rng(1).uniform(0.8, 1.25, len(photos))
    return {
        name: np.clip(np.rint(gain * photo), 0, 255).astype(np.uint8)
        for (name, photo), gain in zip(photos.items(), gains, strict=True)
    }


def test_it_looks_right_from_elsewhere(painting):
    """The bound is of the faces' flatness: finer meshes come closer."""
    picture, shown = photograph_texture(painting.textured).take(ELSEWHERE)
    photo = photograph(ball(5), ELSEWHERE)
    background = (photo == WALL).all(axis=2)
    error = np.abs(picture[shown] - photo[shown])
    assert error.mean() < 1 and np.percentile(error, 99) < 4
    assert fidelity(painting) > 45
    assert (shown == background).mean() < 0.01


def test_a_finer_mesh_comes_closer(photos, painting):
    """Convergence: as long as facets, not pixels, are what is wrong."""
    assert fidelity(paint_from(photos, mesh=ball(3))) + 3 < fidelity(painting)


def test_exposures_do_not_show(exposed, monkeypatch):
    """Property: a fifth of brightness, more or less, leaves next to nothing; without gains it would."""
    assert fidelity(paint_from(exposed)) > 44
    monkeypatch.setattr(paint, "find_gains", lambda samples: np.ones((len(samples), 3)))
    assert fidelity(paint_from(exposed)) < 32


def test_noise_of_photographs_cancels(photos):
    """Property: three or four photographs show most points, so their medians have about half of the noise."""
    generator = np.random.default_rng(2)
    noisy = {
        name: np.clip(np.rint(photo + generator.normal(0, 12, photo.shape)), 0, 255).astype(np.uint8)
        for name, photo in photos.items()
    }
    picture, shown = photograph_texture(paint_from(noisy).textured).take(ELSEWHERE)
    error = (picture - photograph(ball(5), ELSEWHERE))[shown]
    assert 1 < error.std() < 7


def test_what_no_photograph_shows_has_the_colours_beside_it(photos):
    """Property: the foot of a ball of one colour has about that, not black, nor grey; a little of the wall is in it."""
    color = np.array([180.0, 60, 40])
    fine = ball(5)
    plain = {view.name: photograph(fine, view, lambda points: np.tile(color, (len(points), 1))) for view in ring(8)}
    found = paint_from(plain)
    assert 0.02 < found.unseen_share < 0.3
    from_below, shown = photograph_texture(found.textured).take(look_from(1.0, -1.0))
    error = np.abs(from_below[shown] - color)
    assert shown.sum() > 3000 and error.max() < 70 and error.mean() < 12


def test_no_texel_is_black(painting):
    """Property: the pattern is 60 at its darkest; also texels that no face shows are some face's."""
    assert painting.textured.image.min() > 45


def test_what_stands_before_the_object_is_not_painted_on_it(photos):
    """Property: a red bar across one photograph is in none of the others, so no median has it."""
    first = next(iter(photos))
    barred = photos[first].copy()
    barred[70:90] = (255, 0, 0)
    assert fidelity(paint_from(photos | {first: barred})) > 33
    assert fidelity(paint_from({name: barred for name in photos})) < 20


def test_pixels_that_are_not_valid_are_not_used(photos):
    """Property: three photographs are red where they are not valid; next to none of it, at the border, is painted."""
    hidden = np.zeros((160, 160), bool)
    hidden[:, 80:] = True
    names = list(photos)[:3]
    red = {name: np.where(hidden[..., None], np.uint8([255, 0, 0]), photos[name]) for name in names}
    found = paint_from(photos | red, valid=lambda name: ~hidden if name in names else everywhere(name))
    picture, shown = photograph_texture(found.textured).take(ELSEWHERE)
    far = (np.abs(picture - photograph(ball(5), ELSEWHERE)) > 20).any(axis=2)
    assert far[shown].mean() < 0.02


def test_the_share_that_is_not_seen_is_told(photos, painting):
    """Property: nothing of it is in a photograph of nothing; a ring of cameras misses the foot."""
    assert 0.05 < painting.unseen_share < 0.2 and painting.charts >= 9
    nothing = paint_from(photos, valid=lambda name: np.zeros((160, 160), bool))
    assert nothing.unseen_share == 1 and nothing.charts == 1
    assert (nothing.textured.image == 128).all()


def test_texels_in_blocks_are_the_same(photos, painting, monkeypatch):
    """Exact."""
    monkeypatch.setattr(bake, "_BLOCK", 700)
    assert paint_from(photos).textured.image.tobytes() == painting.textured.image.tobytes()


def test_the_same_texels_twice(photos, painting):
    again = paint_from(photos)
    assert again.textured.image.tobytes() == painting.textured.image.tobytes()
    assert again.textured.corners.tobytes() == painting.textured.corners.tobytes()
