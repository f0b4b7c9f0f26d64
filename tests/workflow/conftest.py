"""A copy of the workflow whose stages are stand-ins."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from threedfs.params.document import FILES
from threedfs.params.schema import declared_stages
from threedfs.store.arguments import read_arguments
from threedfs.store.fork_server import ADDRESS

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent

SIGNATURES = {
    "render": ("", "video cameras mesh masks depth", "take"),
    "calibrate": ("boards", "calibration", ""),
    "frames": ("source masks", "frames", ""),
    "features": ("frames", "features", ""),
    "poses": ("frames features cameras calibration", "poses points", "intrinsics"),
    "scale": ("frames poses mesh support", "scale", "known"),
    "keyframes": ("frames poses points masks", "keyframes", ""),
    "shrink": ("frames poses keyframes", "crops views", ""),
    "crops": ("source poses points keyframes support", "crops views", "frame_far_factor"),
    "semidense": ("crops keyframes poses points", "semidense", "keyframe"),
    "edges": ("crops keyframes", "edges", "keyframe"),
    "stereo": ("crops keyframes semidense support", "stereo", "keyframe"),
    "stereo_check": ("keyframes stereo", "checked", "keyframe"),
    "depth": ("crops keyframes semidense edges stereo", "depth", "keyframe"),
    "consistency": ("keyframes depth", "consistency", ""),
    "fuse_scene": ("keyframes points depth consistency", "scene", ""),
    "locate": (
        "scene keyframes points crops semidense edges depth consistency",
        "support",
        "clearance segmentation",
    ),
    "locate_object": ("volume support keyframes semidense", "located", "field"),
    "fuse_object": ("keyframes depth consistency support scene", "volume", ""),
    "fuse_baseline": ("keyframes depth support", "volume", "fusion"),
    "densify": ("crops keyframes poses points support stereo", "cloud", "cuda"),
    "deform": ("field support cloud", "volume", "clearance noise_clearance"),
    "superpixels": ("crops keyframes edges", "superpixels", "keyframe"),
    "segment": (
        "field located support keyframes crops superpixels semidense depth consistency",
        "labels appearance",
        "cut",
    ),
    "spectral_matting": ("field located keyframes crops", "labels", "segmentation"),
    "volumetric_cut": ("support keyframes crops semidense", "labels", ""),
    "cut_object": ("labels field support keyframes poses crops", "mesh silhouettes masks", "method"),
    "surface": (
        "labels appearance keyframes depth consistency support poses crops",
        "mesh silhouettes masks",
        "method fusion segmentation",
    ),
    "texture": ("mesh support keyframes crops", "glb textured", "method"),
    "pixel_masks": ("labels keyframes poses frames", "silhouettes masks", "method"),
    "poisson": ("cloud support keyframes poses frames", "mesh silhouettes masks", ""),
    "object": ("field located keyframes poses frames", "mesh volume silhouettes masks", "method"),
    "evaluate_reconstruction": (
        "poses keyframes depth frames cameras_truth mesh_truth depth_truth",
        "metrics",
        "dataset sequence intrinsics depth_scale depth_camera",
    ),
    "evaluate": (
        "poses keyframes mesh masks silhouettes crops frames masks_truth cameras_truth mesh_truth",
        "metrics",
        "dataset sequence method intrinsics",
    ),
    "photographs": ("mesh textured keyframes crops", "metrics", "dataset sequence method"),
    "depth_trial": (
        "frames crops keyframes edges poses masks_truth cameras_truth mesh_truth depth_truth",
        "trial",
        "keyframe depth_settings depth_scale depth_camera intrinsics",
    ),
    "depth_experiment": ("trials", "metrics", "dataset sequence"),
    "collect": ("tables", "metrics", ""),
}
"""Inputs, outputs and wildcards of each stage: the contract between rules and stages."""

TEMPLATE = '''"""Stand-in for a stage."""

from pathlib import Path

from threedfs.stages.stub import write

{imports}
def run({arguments}):
    write("{stage}", {inputs}, {outputs}, {names}, {params}, job)
'''


class Project:
    """A copy of the project in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.package = folder / "src" / "threedfs"

    @property
    def command(self) -> list[str]:
        """The start of every command line."""
        return [str(BIN / "snakemake"), "--cores", "2"]

    @property
    def environment(self) -> dict[str, str]:
        """The environment in which the copy's package comes first. No job is forked: stand-ins import no libraries."""
        return {**self.forking, ADDRESS: ""}

    @property
    def forking(self) -> dict[str, str]:
        """The same with jobs that are forked. Output is buffered, as it is for most people."""
        inherited = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
        return {**inherited, "PYTHONPATH": str(self.folder / "src"), "PATH": f"{BIN}:{os.environ['PATH']}"}

    def run(self, *arguments: str, good: bool = True) -> str:
        """Run snakemake and return all that it printed; fail unless it ended as expected."""
        status, output = self._finish([*self.command, *arguments], self.folder)
        assert (status == 0) is good, output
        return output

    def call(self, folder: Path, *words: str) -> tuple[int, str]:
        """Call the copy's command `threedfs` in a folder; return status and output."""
        return self._finish([sys.executable, "-m", "threedfs.cli.main", *words], folder)

    def _finish(self, words: list[str], folder: Path) -> tuple[int, str]:
        done = subprocess.run(
            words,
            cwd=folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout

    def edit(self, path: str, old: str, new: str) -> None:
        """Replace text in a file of the copy."""
        file = self.folder / path
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))

    def artifacts(self) -> dict[str, bytes]:
        """Read all results by relative path, without logs, benchmarks, store, notes, and reports (they tell costs)."""
        results = self.folder / "results"
        files = (file for file in sorted(results.rglob("*")) if file.is_file())
        names = ((file.relative_to(results), file) for file in files)
        kept = (
            (name, file)
            for name, file in names
            if not {"logs", "benchmarks", ".store", ".made", "report.html"} & set(name.parts)
        )
        return {name.as_posix(): file.read_bytes() for name, file in kept}


@pytest.fixture(scope="session")
def signatures() -> dict[str, tuple[str, str, str]]:
    """Inputs, outputs and wildcards of each stage."""
    return SIGNATURES


@pytest.fixture
def project(tmp_path: Path) -> Project:
    """A project whose stages are stand-ins and whose sample is a few bytes."""
    return make_project(tmp_path / "project")


@pytest.fixture(scope="session")
def first_run(tmp_path_factory) -> tuple[Project, str]:
    """A project after its first run, and what that printed; not to be changed."""
    project = make_project(tmp_path_factory.mktemp("finished") / "project")
    return project, project.run()


@pytest.fixture
def finished(first_run, tmp_path: Path) -> Project:
    """A copy of a project after its first run."""
    shutil.copytree(first_run[0].folder, tmp_path / "project")
    return Project(tmp_path / "project")


def make_project(folder: Path) -> Project:
    """Copy the project, with stand-ins for its stages and sample."""
    for name in ("src/threedfs", "workflow", "config", "profiles", "envs"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "Snakefile", folder)
    for name, make in FILES.items():  # in step even when the committed ones are not, which is another test's matter
        # one method of few stages: what methods share has tests of its own
        (folder / name).write_text(
            make().replace("methods: [surface, gc_2d3d_pixel, sdf_2d3d_voxel]", "methods: [fused_sdf]")
        )
    sample = folder / "resources" / "sample"
    (sample / "masks").mkdir(parents=True)
    for name in ("video.mp4", "cameras.json", "mesh.ply", "masks/000001.png"):
        (sample / name).write_text(name)
    write_stub_stages(folder / "src" / "threedfs", set(declared_stages()))
    return Project(folder)


def write_stub_stages(package: Path, with_params: set[str]) -> None:
    """Replace the stages in a copy of the package by stand-ins; collect stays what it is.

    Parameters
    ----------
    package : Path
        Folder of the copy.
    with_params : set of str
        Stages that have parameters.
    """
    for stage, names in SIGNATURES.items():
        if stage == "collect":
            continue
        inputs, outputs, wildcards = (text.split() for text in names)
        real = read_arguments(f"threedfs.stages.{stage}")  # which of them are lists of files
        params = ["params"] if stage in with_params else []
        text = TEMPLATE.format(
            stage=stage,
            imports=f"import threedfs.params.{stage}\n\n" if params else "",
            arguments="*, "
            + ", ".join(_annotate(name, real) for name in [*inputs, *outputs, *wildcards, *params, "job"]),
            inputs=_mapping(inputs),
            outputs=_mapping(outputs),
            names=_mapping(wildcards),
            params="params" if params else None,
        )
        (package / "stages" / f"{stage}.py").write_text(text)
    shutil.copy(Path(__file__).with_name("stub.py"), package / "stages" / "stub.py")
    # the files of these projects are a few letters each
    (package / "inputs" / "look.py").write_text("def look(entry, frames):\n    return []\n")


def _annotate(name: str, real: dict[str, str]) -> str:
    return f"{name}: {real[name]}" if "Path" in real.get(name, "") else name


def _mapping(names: list[str]) -> str:
    return "{" + ", ".join(f'"{name}": {name}' for name in names) + "}"
