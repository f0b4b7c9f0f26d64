"""Contract: rules, stages and stand-ins agree; the rules are clean by Snakemake's and its formatter's own judgement."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from threedfs.params.schema import declared_stages

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent


def run_arguments(stage: str) -> set[str]:
    """Read the names of a stage's arguments from its source."""
    tree = ast.parse((ROOT / "src/threedfs/stages" / f"{stage}.py").read_text())
    (run,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "run")
    assert not run.args.args, f"{stage}.run takes its arguments by name only"
    return {argument.arg for argument in run.args.kwonlyargs}


def test_every_stage_has_the_signature_that_its_rule_and_stand_in_have(signatures):
    for stage, names in signatures.items():
        expected = {name for text in names for name in text.split()} | {"job"}
        expected |= {"params"} if stage in declared_stages() else set()
        assert run_arguments(stage) == expected, stage


def test_every_stage_module_has_a_rule(signatures):
    modules = {path.stem for path in (ROOT / "src/threedfs/stages").glob("*.py")} - {"__init__"}
    assert modules == set(signatures)


def test_every_rule_has_all_blocks_in_one_order():
    blocks = "input output log benchmark conda threads resources params message script".split()
    optional = {"wildcard_constraints", "priority"}
    for path in sorted((ROOT / "workflow/rules").glob("*.smk")):
        if path.name in ("common.smk", "inputs.smk", "run.smk"):
            continue
        for rule in path.read_text().split("\n\n\n")[1:]:
            found = [name for name in re.findall(r"^    (\w+):", rule, re.MULTILINE) if name not in optional]
            own = blocks if "input" in found else blocks[1:]  # the first rule makes its data from nothing
            assert found == own, f"{path.name}: {rule.splitlines()[0]}"


def test_common_rules_stay_short():
    assert len((ROOT / "workflow/rules/common.smk").read_text().splitlines()) < 80


def test_snakemake_lint_finds_nothing(project):
    assert "Congratulations" in project.run("--lint")


@pytest.mark.parametrize("tool", [["snakefmt", "--check", "Snakefile", "workflow"]])
def test_rules_are_formatted(tool):
    done = subprocess.run([str(BIN / tool[0]), *tool[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
