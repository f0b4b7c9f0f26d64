"""Contract: what the documents tell users to set is there to be set."""

import re
from pathlib import Path

import pytest

from threedfs.cli.request import read_settings
from threedfs.params.schema import default_settings, find_params, make_params

ROOT = Path(__file__).resolve().parents[2]
KNOBS = [
    (name, knob)
    for name in ("README.md", "docs/knobs.md")
    for knob in re.findall(r"(\w+\.\w+=[^\s`]+)", (ROOT / name).read_text())
]


@pytest.mark.parametrize(("name", "knob"), KNOBS)
def test_a_knob_can_be_turned(name, knob):
    ((stage, settings),) = read_settings([knob]).items()
    declared = find_params(stage)
    before = default_settings(declared)
    assert set(settings) <= set(before)
    make_params(declared, {**before, **settings})


def test_every_document_that_is_linked_is_there():
    for path in [
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *(ROOT / "docs").glob("*.md"),
        ROOT / "config/README.md",
    ]:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text()):
            assert (path.parent / link).exists(), f"{path.name}: {link}"
