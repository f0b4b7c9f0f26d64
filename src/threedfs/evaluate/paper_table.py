"""The foreground IoU that the paper prints: its Table 1 (Section 4.3, label tab:fgIOU).

Measured by the paper's authors on their Object-Videos data set, twelve phone videos of ten objects. Our sequences of
the same names are other videos of other objects, so these numbers are context and no comparison on equal data.
"""

from __future__ import annotations

SEQUENCES = (
    "dragon",
    "stapler",
    "rubik_cube",
    "paper_punch",
    "keyboard",
    "teabox",
    "books",
    "helmet",
    "hedgehog1",
    "hedgehog2",
    "godzilla1",
    "godzilla2",
)

PRINTED = {
    "Fused SDF": (0.86, 0.79, 0.83, 0.73, 0.74, 0.74, 0.88, 0.84, 0.82, 0.73, 0.82, 0.78),
    "Deformed SDF": (0.87, 0.82, 0.85, 0.81, 0.76, 0.54, 0.81, 0.79, 0.63, 0.80, 0.58, 0.82),
    "Volumetric GC": (0.90, 0.86, 0.76, 0.88, 0.68, 0.85, 0.35, 0.37, 0.86, 0.86, 0.81, 0.90),
    "2D GC": (0.90, 0.90, 0.95, 0.93, 0.76, 0.94, 0.88, 0.84, 0.83, 0.88, 0.80, 0.91),
    "2D-3D GC Pixel": (0.91, 0.90, 0.95, 0.93, 0.78, 0.87, 0.92, 0.87, 0.85, 0.85, 0.83, 0.91),
    "2D-3D GC Voxel": (0.91, 0.90, 0.93, 0.88, 0.73, 0.84, 0.92, 0.88, 0.87, 0.82, 0.80, 0.88),
    "GC Select": (0.90, 0.89, 0.91, 0.88, 0.74, 0.82, 0.92, 0.87, 0.86, 0.80, 0.79, 0.86),
    "SDF + 2D-3D Voxel": (0.90, 0.89, 0.91, 0.88, 0.73, 0.82, 0.91, 0.87, 0.86, 0.79, 0.79, 0.85),
}
"""IoU by method, in the order of `SEQUENCES`."""

PRINTED_MEAN = {
    "Fused SDF": 0.80,
    "Deformed SDF": 0.76,
    "Volumetric GC": 0.76,
    "2D GC": 0.88,
    "2D-3D GC Pixel": 0.88,
    "2D-3D GC Voxel": 0.86,
    "GC Select": 0.85,
    "SDF + 2D-3D Voxel": 0.85,
}
"""Its column "mean"."""

PRINTED_MEDIAN = {
    "Fused SDF": 0.80,
    "Deformed SDF": 0.81,
    "Volumetric GC": 0.85,
    "2D GC": 0.89,
    "2D-3D GC Pixel": 0.88,
    "2D-3D GC Voxel": 0.88,
    "GC Select": 0.87,
    "SDF + 2D-3D Voxel": 0.87,
}
"""Its column "median"."""
