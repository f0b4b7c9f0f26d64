"""Views as plain values for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from threedfs.types import Camera, View


def encode_view(view: View) -> dict[str, Any]:
    """Return the view as plain values; float64 survives the round trip exactly."""
    return {"name": view.name, "camera": asdict(view.camera), "cam_from_world": view.cam_from_world.tolist()}


def decode_view(content: dict[str, Any]) -> View:
    """Return the view that `encode_view` encoded."""
    return View(content["name"], Camera(**content["camera"]), np.array(content["cam_from_world"], np.float64))
