"""What is read of results to plan, by rules and by jobs: as another job wrote it, and nothing else."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.store.made import Made
from threedfs.store.objects import DamagedObject
from threedfs.store.place import Store


def read_result(path: Path, store: Store) -> dict[str, Any]:
    """Return the content of a JSON file of the results as its job wrote it; it is only read.

    If the file is damaged its content is taken from the store; the first job that computes with it puts it back.

    Raises
    ------
    UserError
        If it is damaged, and the store has no copy.
    """
    status = path.stat()
    return _read(path, store, status.st_mtime_ns, status.st_size, status.st_ino)


@cache  # every job of a sequence asks for it
def _read(path: Path, store: Store, *_stamp: int) -> dict[str, Any]:
    data, digest = path.read_bytes(), Made(store.made).find(path) if store.made else None
    if isinstance(digest, str) and hashlib.sha256(data).hexdigest() != digest:
        try:
            data = store.objects.read(digest)
        except DamagedObject:
            raise UserError(
                f"{path}: expected the file that its job wrote, but it is another, and the store has no copy of it; "
                f"delete {path} and run again."
            ) from None
    return json.loads(data)
