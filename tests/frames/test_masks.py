"""Exact: which frame a mask belongs to."""

from threedfs.frames.masks import match_masks


def test_in_a_video_numbers_count():
    names = [f"{i:06d}" for i in range(20)]
    stems = ["3", "000004", "0017", "20", "mask", "-1", "5.0", "²"]
    assert match_masks(stems, names, numbered=True) == {"000003": "3", "000004": "000004", "000017": "0017"}


def test_among_photos_names_count():
    assert match_masks(["1", "a", "b"], ["01", "a"], numbered=False) == {"a": "a"}
