"""Makes the closed-form scenes of the depth tests importable."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "depth"))
