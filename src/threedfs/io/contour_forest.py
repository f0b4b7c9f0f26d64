"""The forest of the contour detector, as a file of the package."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path

import numpy as np

from threedfs.edges.forest import Forest
from threedfs.errors import UserError
from threedfs.io.atomic import atomic

SHA256 = "074817e1a5294074799953424385a3d654dbbecf8f627d4b042ca19b01d03368"
"""Of the file that the package carries. Being source, it is part of the identity of all that reads the forest."""

CARRIED = Path(__file__).parents[1] / "edges" / "contours.npz"
_LEAF = np.iinfo(np.uint16).max


def read_forest(path: Path = CARRIED, digest: str = SHA256) -> Forest:
    """Read a forest.

    Parameters
    ----------
    path : Path
    digest : str
        SHA-256 that the file must have.

    Raises
    ------
    UserError
        If the file is missing or is another.
    """
    if not path.is_file():
        raise UserError(f"{path}: expected the forest of the contour detector, found none; install threedfs again.")
    content = path.read_bytes()
    found = hashlib.sha256(content).hexdigest()
    if found != digest:
        raise UserError(
            f"{path}: expected the forest with SHA-256 {digest}, got {found}; install threedfs again, or train it "
            "with `make contours`."
        )
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        feature = arrays["feature"].astype(np.int32)
        return Forest(
            arrays["roots"],
            np.where(feature == _LEAF, -1, feature).astype(np.int32),
            arrays["threshold"].astype(np.float32),
            arrays["child"],
            arrays["labels"],
        )


def write_forest(path: Path, forest: Forest) -> str:
    """Write a forest whose thresholds survive half precision; return the SHA-256 of the file."""
    feature = np.where(forest.feature < 0, _LEAF, forest.feature).astype(np.uint16)
    with atomic(path) as temporary, open(temporary, "wb") as file:
        np.savez_compressed(
            file,
            roots=forest.roots,
            feature=feature,
            threshold=forest.threshold.astype(np.float16),
            child=forest.child,
            labels=forest.labels,
        )
    return hashlib.sha256(path.read_bytes()).hexdigest()
