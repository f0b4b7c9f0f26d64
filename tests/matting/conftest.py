"""Makes the scenes of other tests importable: balls on tables, labelled in closed form or rendered."""

import sys
from pathlib import Path

for topic in ("segment", "synthetic"):
    sys.path.insert(0, str(Path(__file__).parents[1] / topic))
