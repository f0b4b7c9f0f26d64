"""Parameters of the spectral_matting stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SpectralMattingParams:
    """How a keyframe is split into soft components; what bounds the object from outside is set in segment."""

    pixels: int = parameter(
        60_000, "a keyframe is looked at around the object, in so many pixels at most", unit="pixel", minimum=1_000
    )
    epsilon: float = parameter(
        1e-6, "holds back what colours that hardly differ say of the opacity", exclusive_minimum=0.0
    )
    eigenvectors: int = parameter(
        50, "smallest eigenvectors of the matting Laplacian that components are made of", minimum=2, maximum=500
    )
    components: int = parameter(
        20, "components at most; all sets of them are tried, so that each more doubles these", minimum=2, maximum=20
    )
    sparsity: float = parameter(
        0.9,
        "exponent of the prior that draws a component's values to 0 and 1",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    iterations: int = parameter(20, "steps towards that; 0 leaves the clusters as projected", minimum=0, maximum=1000)
    inner_level: float = parameter(
        -0.5,
        "pixels that show the object where its field is below this are its for certain",
        unit="clip distance",
        equation="Sec. 3.4.2",
        minimum=-1.0,
        maximum=0.0,
    )
