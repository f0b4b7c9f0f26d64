"""From HDR video to the range and the colours of ordinary video.

The curve is ours and simple; reference white and the transfer functions are those of ITU-R BT.2100 and BT.2408.
"""

from __future__ import annotations

import cv2
import numpy as np

PQ, HLG = 16, 18
"""Transfer characteristics of HDR video, as ITU-T H.273 numbers them."""
TRANSFERS = {PQ: "PQ", HLG: "HLG"}

_WHITE = 203.0  # candela per square metre of SDR white (BT.2408)
_KNEE = 0.75  # of white: what is darker stays as it is
_PEAK = 1000.0  # candela per square metre of the display that HLG is made for
_HLG_GAMMA = 1.2  # of that display (BT.2100)
_BT2020_LUMA = np.array([0.2627, 0.6780, 0.0593])
_RGB_FROM_YUV = np.array([[1.0, 0.0, 1.4746], [1.0, -0.16455, -0.57135], [1.0, 1.8814, 0.0]])
"""BT.2020, non-constant luminance."""
_BT709_FROM_BT2020 = np.array(
    [[1.660491, -0.587641, -0.072850], [-0.124550, 1.132900, -0.008349], [-0.018151, -0.100579, 1.118730]]
)
_LEVELS = 4096  # of the tables: finer than the 10 bits of the video
_SDR_LEVELS = 16384


def decode_pq(signal: np.ndarray) -> np.ndarray:
    """Return the light, in shares of SDR white, of a PQ signal in [0, 1] (SMPTE ST 2084).

    Examples
    --------
    >>> np.round(decode_pq(np.array([0.0, 0.5806889, 1.0])), 3)
    array([ 0.   ,  1.   , 49.261])
    """
    m1, m2 = 2610 / 16384, 2523 / 4096 * 128
    c1, c2, c3 = 3424 / 4096, 2413 / 4096 * 32, 2392 / 4096 * 32
    root = np.asarray(signal, np.float64) ** (1 / m2)
    return 10000 / _WHITE * (np.maximum(root - c1, 0) / (c2 - c3 * root)) ** (1 / m1)


def decode_hlg(signal: np.ndarray) -> np.ndarray:
    """Return the light of the scene, in [0, 1], of an HLG signal in [0, 1] (BT.2100, inverse OETF).

    Examples
    --------
    >>> np.round(decode_hlg(np.array([0.0, 0.5, 0.75, 1.0])), 4)
    array([0.    , 0.0833, 0.265 , 1.    ])
    """
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    signal = np.asarray(signal, np.float64)
    return np.where(signal <= 0.5, signal**2 / 3, (np.exp((signal - c) / a) + b) / 12)


def compress(light: np.ndarray) -> np.ndarray:
    """Bring light in shares of SDR white below 1: unchanged up to 0.75, then ever less steep, without a kink.

    Examples
    --------
    >>> np.round(compress(np.array([0.18, 0.75, 1.0, 4.0])), 3)
    array([0.18 , 0.75 , 0.908, 1.   ])
    """
    room = 1 - _KNEE
    return np.where(light <= _KNEE, light, 1 - room * np.exp(-(np.maximum(light, _KNEE) - _KNEE) / room))


def tone_map(yuv: np.ndarray, transfer: int, *, full_range: bool = False) -> np.ndarray:
    """Make an ordinary picture of a frame of HDR video in BT.2020.

    Colours keep their hue: the curve acts on the largest of red, green and blue, and all three are scaled alike. What
    BT.709 cannot show is cut off. The picture is encoded as sRGB, as viewers take textures to be.

    Parameters
    ----------
    yuv : (H, W, 3) uint16
        Luma and both chromas, scaled to 16 bits.
    transfer : int
        `PQ` or `HLG`.
    full_range : bool
        Whether black is 0 and white the largest number, or the usual range of video.

    Returns
    -------
    (H, W, 3) uint8 RGB
    """
    values = yuv.astype(np.float32) / np.float32(256)
    black, steps, chroma = (0.0, 255.996, 255.996) if full_range else (16.0, 219.0, 224.0)
    matrix = (_RGB_FROM_YUV / [steps, chroma, chroma]).astype(np.float32)
    offset = -matrix @ np.array([black, 128.0, 128.0], np.float32)
    signal = _mix(values, matrix) + offset
    if transfer == PQ:
        light = _look_up(signal, _PQ_TABLE)
    else:
        scene = _look_up(signal, _HLG_TABLE)
        luma = np.maximum(_mix(scene, _BT2020_LUMA[None].astype(np.float32)), np.float32(1e-6))
        light = scene * (np.float32(_PEAK / _WHITE) * luma ** np.float32(_HLG_GAMMA - 1))[..., None]
    light = np.maximum(_mix(light, _BT709_FROM_BT2020.astype(np.float32)), 0)
    brightest = np.maximum(light.max(axis=-1), np.float32(1e-6))
    light *= (compress(brightest) / brightest).astype(np.float32)[..., None]
    return _SRGB_TABLE[np.clip(light * (_SDR_LEVELS - 1) + np.float32(0.5), 0, _SDR_LEVELS - 1).astype(np.int32)]


def _mix(values: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Apply a matrix (C, 3) to the channels, in the same order of sums on any number of threads."""
    return cv2.transform(values, matrix)


def _look_up(signal: np.ndarray, table: np.ndarray) -> np.ndarray:
    return table[np.clip(signal * (_LEVELS - 1) + np.float32(0.5), 0, _LEVELS - 1).astype(np.int32)]


def _encode_srgb(light: np.ndarray) -> np.ndarray:
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


_PQ_TABLE = decode_pq(np.linspace(0, 1, _LEVELS)).astype(np.float32)
_HLG_TABLE = decode_hlg(np.linspace(0, 1, _LEVELS)).astype(np.float32)
_SRGB_TABLE = np.rint(255 * _encode_srgb(np.linspace(0, 1, _SDR_LEVELS))).astype(np.uint8)
