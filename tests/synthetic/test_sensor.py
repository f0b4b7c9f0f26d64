"""Property tests of exposure and noise."""

import numpy as np

from threedfs.synthetic.sensor import Sensor

GREY = np.full((200, 200, 3), 0.3)
CLEAN = {"drift": 0.0, "tint_drift": 0.0, "shot_noise": 0.0, "read_noise": 0.0}


def test_without_noise_the_image_is_even_and_monotonic():
    assert np.ptp(Sensor(**CLEAN).record(GREY, 0, 0.0)) == 0
    ramp = np.repeat(np.linspace(0, 3, 300)[None, :, None], 3, axis=2)
    tone = Sensor(**CLEAN).record(ramp, 0, 0.0)[0, :, 0].astype(int)
    assert tone[0] == 0 and np.all(np.diff(tone) >= 0) and tone[-1] > 240


def test_noise_grows_with_light_and_differs_from_frame_to_frame():
    noisy = Sensor(**(CLEAN | {"shot_noise": 0.02}))
    assert np.all(noisy.record(0 * GREY, 0, 0.0) == 0)
    first, second = noisy.record(GREY, 0, 0.0), noisy.record(GREY, 1, 0.0)
    # Slope of the curve at 0.3 is about 320 levels per unit of light; deviation 0.02 * sqrt(0.3) = 0.011.
    assert 2.0 < first.std() < 5.0
    assert abs(np.corrcoef(first.ravel(), second.ravel())[0, 1]) < 0.02
    assert np.array_equal(first, noisy.record(GREY, 0, 0.0))


def test_exposure_drifts_within_its_amplitude():
    sensor = Sensor(drift=0.1, tint_drift=0.02)
    factor = np.array([sensor.exposure(t) for t in np.linspace(0, 60, 600)])
    assert np.all(np.abs(factor - 1) < 1.1 * 1.04 - 1 + 1e-9)
    assert np.ptp(factor.mean(axis=1)) > 0.1
    assert np.ptp(factor[:, 0] / factor[:, 2]) > 0.01
