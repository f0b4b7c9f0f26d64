"""From light to the bytes a phone records: exposure, noise, tone curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Sensor:
    """How radiance becomes an image.

    Attributes
    ----------
    gain : float
        Exposure: a radiance of 1 / gain becomes a bright tone.
    drift : float
        Relative amplitude of slow exposure changes.
    tint_drift : float
        Relative amplitude of slow changes of the white balance.
    shot_noise, read_noise : float
        Standard deviation at full exposure (grows with the root of light) and in the dark, of full scale.
    seed : int
    """

    gain: float = 1.0
    drift: float = 0.08
    tint_drift: float = 0.02
    shot_noise: float = 0.012
    read_noise: float = 0.003
    seed: int = 0

    def record(self, radiance: np.ndarray, frame: int, time: float) -> np.ndarray:
        """Return frame number `frame`, (H, W, 3) uint8 sRGB, of linear radiance (H, W, 3)."""
        light = radiance * self.gain * self.exposure(time)
        rng = np.random.default_rng([self.seed, frame])
        deviation = np.sqrt(self.read_noise**2 + self.shot_noise**2 * light)
        light = np.maximum(light + deviation * rng.standard_normal(light.shape), 0)
        tone = 1 - np.exp(-light)  # highlights roll off instead of clipping
        tone = tone**1.18  # a phone's contrast
        encoded = np.where(tone <= 0.0031308, 12.92 * tone, 1.055 * tone ** (1 / 2.4) - 0.055)
        return np.clip(np.rint(encoded * 255), 0, 255).astype(np.uint8)

    def exposure(self, time: float) -> np.ndarray:
        """Return the slow factor (3,) on linear RGB at a time in seconds."""
        phase = np.random.default_rng(self.seed).uniform(0, 2 * np.pi, 5)
        level = 0.6 * np.sin(2 * np.pi * 0.17 * time + phase[0]) + 0.4 * np.sin(2 * np.pi * 0.41 * time + phase[1])
        tint = np.sin(2 * np.pi * 0.11 * time + phase[2:])
        return (1 + self.drift * level) * (1 + self.tint_drift * (tint - tint.mean()))
