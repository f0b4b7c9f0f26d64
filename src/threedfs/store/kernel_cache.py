"""How numba keeps compiled kernels: one sealed file for each, instead of an index and numbered files.

numba finds this module by its variable NUMBA_CACHE_LOCATOR_CLASSES, when it meets the first kernel to keep. Its own
files have no checksum; and two processes that compile for different types at once may give both the same number.
"""

from __future__ import annotations

import hashlib
import os
import pickle
from pathlib import Path
from typing import Any

from numba.core import caching, config

from threedfs.store.kernels import ENDING, read_kernel, write_kernel


class SealedFiles(caching.IndexDataCacheFile):
    """The kept kernels of one function."""

    def load(self, key: Any) -> Any:
        """Return what was kept under a key, or None if nothing was that can be trusted."""
        data = read_kernel(self._root, self._file(key))
        if data is None:
            return None
        kept, kernel = pickle.loads(data)
        return kernel if kept == self._whole(key) else None

    def save(self, key: Any, data: Any) -> None:
        """Keep a kernel; where that cannot be, it is compiled again next time."""
        try:
            write_kernel(self._root, self._file(key), self._dump((self._whole(key), data)))
        except OSError:
            pass

    def flush(self) -> None:
        """Forget all kernels of the function."""
        for path in Path(self._cache_path).glob(f"{self._stem}.*{ENDING}"):
            path.unlink(missing_ok=True)

    @property
    def _root(self) -> Path:
        return Path(config.CACHE_DIR).parent  # type: ignore[attr-defined]

    @property
    def _stem(self) -> str:
        return self._index_name.removesuffix(".nbi")

    def _whole(self, key: Any) -> tuple:
        return (self._version, self._source_stamp, key)

    def _file(self, key: Any) -> Path:
        name = hashlib.sha256(repr(self._whole(key)).encode()).hexdigest()[:16]
        return Path(self._cache_path) / f"{self._stem}.{name}{ENDING}"


class Locator(caching.UserProvidedCacheLocator):
    """Has numba keep kernels in the folder that it is told, in sealed files."""

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Locator | None:
        """Return the locator of a function in a file."""
        caching.IndexDataCacheFile = SealedFiles  # type: ignore[misc]  # numba makes one of these next
        return cls(py_func, py_file) if os.path.exists(py_file) else None

    def ensure_cache_path(self) -> None:
        """Do nothing: the folder is made when a kernel is written."""
