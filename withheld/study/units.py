"""Made-up units: three gyros at right angles, four in a tetrahedron, six in a cone, each a little off."""

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Unit


def _axes(n: int) -> Array:
    """Nominal directions, (n, 3)."""
    if n == 3:
        return np.eye(3)
    if n == 4:
        # three on a cone about x, one along it
        cone = [[1 / 3, np.sqrt(8) / 3 * np.cos(a), np.sqrt(8) / 3 * np.sin(a)] for a in (0, 2.0944, 4.1888)]
        return np.array([*cone, [1.0, 0.0, 0.0]])
    if n == 6:
        tilt = 0.9553  # half angle of a cone whose six axes see all directions alike
        return np.array(
            [
                [np.cos(tilt), np.sin(tilt) * np.cos(a), np.sin(tilt) * np.sin(a)]
                for a in np.arange(6) * np.pi / 3
            ]
        )
    raise ValueError(f"no arrangement of {n} gyros; expected 3, 4 or 6")


def draw_unit(n: int, name: str, rng: np.random.Generator) -> Unit:
    """A tactical-grade unit: white noise 1.2e-3 to 3e-3 deg/sqrt(h), flicker 0.02 to 0.05 deg/h.

    Scale factors, biases and stated uncertainties lie about those of the published unit.
    """

    def around(centre: float, spread: float, digits: int) -> tuple[float, ...]:
        return tuple(round(float(v), digits) for v in centre * np.exp(spread * rng.standard_normal(n)))

    tilted = _axes(n) + 2e-3 * rng.standard_normal((n, 3))
    h = np.linalg.pinv(tilted / np.linalg.norm(tilted, axis=1, keepdims=True))
    rows = [tuple(float(v) for v in np.round(row, 12)) for row in h]
    walk = around(0.05, 0.3, 4) if rng.random() < 0.3 else (0.0,) * n
    return Unit(
        name=name, version="1", H=(rows[0], rows[1], rows[2]),
        scale_factor=around(0.083, 0.1, 9),
        bias=tuple(round(float(v), 12) for v in 4e-4 * rng.standard_normal(n)),
        scale_factor_rel=around(2e-5, 0.2, 7), bias_sd=(1e-9,) * n, axis_rad=around(2e-5, 0.2, 7),
        turn_on_deg_h=around(0.05, 0.2, 4), arw_deg_sqrt_h=around(2e-3, 0.2, 6),
        instability_deg_h=around(0.03, 0.2, 4), rrw_deg_h_sqrt_h=walk,
    )  # fmt: skip
