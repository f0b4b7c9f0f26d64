"""Masks beside exported images, named as each program looks for them."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np
from PIL import Image

from threedfs.io.atomic import atomic
from threedfs.io.images import write_mask, write_png
from threedfs.matting.closed_form import matte_outline

MASKS = ("colmap", "nerfstudio", "openmvs", "rgba", "alpha")
"""Programs, or kinds, that masks are written for."""


def mask_path_of(file: str) -> str:
    """Return where the mask of an image lies for COLMAP and nerfstudio, relative to the exported folder."""
    return f"masks/{file}.png"


def write_masks(folder: Path, file: str, image: np.ndarray, mask: np.ndarray, kinds: Collection[str]) -> None:
    """Write the mask of an exported image, of the same size, in the conventions of some programs.

    - colmap, nerfstudio: `masks/NAME.png.png`, white on black; COLMAP finds it by the name of the image, nerfstudio by
      `mask_path` in transforms.json;
    - openmvs: `masks_openmvs/NAME.mask.png`, 255 on 0, for `--mask-path` with `--ignore-mask-label 0`;
    - rgba: `images_rgba/NAME.png`, the image with the mask as alpha; colours stay beside the object, too;
    - alpha: `alphas/NAME.png`, 8 bits, the share of each pixel that the object covers, by matting about the outline. It
      is then the alpha of `rgba`, too.

    Parameters
    ----------
    folder : Path
    file : str
        Name of the image, NAME.png.
    image : (H, W, 3) uint8
    mask : (H, W) bool
    kinds : collection of str
        Of `MASKS`.
    """
    if {"colmap", "nerfstudio"} & set(kinds):
        write_mask(folder / mask_path_of(file), mask)
    if "openmvs" in kinds:
        write_mask(folder / "masks_openmvs" / f"{file.removesuffix('.png')}.mask.png", mask)
    alpha = mask.astype(np.uint8) * 255
    if "alpha" in kinds:
        alpha = np.rint(matte_outline(image, mask) * 255).astype(np.uint8)
        write_png(folder / "alphas" / file, alpha)
    if "rgba" in kinds:
        with atomic(folder / "images_rgba" / file) as temporary:
            Image.fromarray(np.dstack([image, alpha])).save(temporary, format="png")
