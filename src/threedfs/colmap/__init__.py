"""The only place that imports pycolmap.

zlib must be loaded first: pycolmap 4.1.1 to 4.2.1 brings symbols that otherwise make the first zlib call of
the process abort ("free(): invalid pointer").
"""

import zlib as zlib  # isort: skip
import pycolmap

# COLMAP reports every step on standard error; faults reach us as exceptions or missing results.
pycolmap.logging.minloglevel = pycolmap.logging.FATAL.value
