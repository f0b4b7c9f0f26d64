"""Rejection tests of the command line."""

import pytest

from threedfs.synthetic.__main__ import main


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["sample", "FILE"], "expected a folder to write into, got a file"),
        (["sample", "out", "--processes", "0"], "expected at least 1, got 0"),
        (["example", "out"], "invalid choice"),
        (["sample"], "required: output"),
        (["take", "mug", "out"], "invalid choice: 'mug'"),
        (["take", "books", "out", "--width", "100"], "render.width: expected a multiple of 8, got 100"),
        (["take", "books", "out", "--frames", "1"], "--frames: expected at least 2, got 1"),
    ],
)
def test_bad_words_stop_with_a_sentence(words, sentence, tmp_path, capsys):
    taken = tmp_path / "taken"
    taken.write_text("")
    with pytest.raises(SystemExit) as stop:
        main([str(taken) if word == "FILE" else word for word in words])
    assert stop.value.code == 2
    assert sentence in capsys.readouterr().err
