"""Spectra in which lines are looked for, and which are free of them afterwards."""

from __future__ import annotations

import numpy as np
from line_streams import FOUR, NOISE, RATE, Facts, quiet, wave

from fogreduce.diagnosis.which.full_rate.line_spectra import Spectra


def test_a_line_taken_out_leaves_noise_and_is_not_found_again() -> None:
    streams = quiet(21)
    for one in streams:
        one[2] += wave(60.0, 17.3)
    spectra = Spectra.of(streams, [Facts(f"r{k}", FOUR) for k in range(2)])  # type: ignore[arg-type]
    assert spectra is not None
    peak = int(np.argmax(np.abs(spectra.lines[0, 2])))
    hz = spectra.refined(float(spectra.hz[peak]), [2])
    assert abs(hz - 17.3) < 0.01 * RATE / len(streams[0][0])
    (size,) = np.abs(spectra.without(hz, [2])).T
    assert np.allclose(size, 60.0, atol=5.0 * NOISE * np.sqrt(2.0 / len(streams[0][0])))
    assert np.max(np.abs(spectra.lines[0, 2])) < 7.0
    assert not spectra.free[2, peak]
    assert spectra.free[1].all()
