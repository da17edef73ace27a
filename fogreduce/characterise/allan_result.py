"""What `fogreduce.allan` returns: channels with their Allan deviations, drawn or as an xarray Dataset."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fogreduce.characterise.allan_channel import Channel
from fogreduce.characterise.allan_freedom import Kind

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Allan:
    """What `allan` returns: `channels`, to be had by name too (``result["gyro1"]``).

    Attributes
    ----------
    channels : list of Channel
    interval_s : float
        Between two samples [s].
    about : dict
        Where the data come from; empty for arrays.
    """

    channels: list[Channel]
    interval_s: float
    about: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Channel:
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise KeyError(f"no channel {name}; there are {', '.join(one.name for one in self.channels)}")

    def __repr__(self) -> str:
        lines = [f"Allan deviation of {len(self.channels)} channels, {self.interval_s:g} s between samples"]
        for channel in self.channels:
            shown = [
                f"{one.noise.symbol} = {one.value:.3g} ± {one.error:.1g} {one.noise.unit}"
                for one in channel.coefficients
                if one.significant
            ]
            lines.append(f"  {channel.name}: " + (", ".join(shown) or "no coefficient determined"))
        return "\n".join(lines)

    def plot(self, kind: Kind = "overlapping") -> Figure:
        """Deviations with their limits and the fitted noise, and the spectral density, as a figure."""
        from fogreduce.characterise.allan_figure import draw_result
        from fogreduce.plotting.style import style

        with style():
            return draw_result(self.channels, self.about, kind)

    def to_dataset(self) -> xr.Dataset:
        """The deviations as an xarray Dataset along ``channel``, ``kind`` and ``tau``."""
        import xarray as xr

        kinds = list(self.channels[0].deviations)
        tau_s = self.channels[0].deviations[kinds[0]].tau_s
        variables = {}
        for name, unit in _COLUMNS.items():
            stacked = [[getattr(one.deviations[kind], name) for kind in kinds] for one in self.channels]
            variables[name] = (("channel", "kind", "tau"), np.array(stacked), {"units": unit})
        coordinates = {
            "channel": [one.name for one in self.channels],
            "kind": kinds,
            "tau": ("tau", tau_s, {"units": "s"}),
        }
        return xr.Dataset(variables, coordinates, dict(self.about))


_COLUMNS = {
    "deviation": "degree h-1",
    "low_68": "degree h-1",
    "high_68": "degree h-1",
    "low_95": "degree h-1",
    "high_95": "degree h-1",
    "alpha": "1",
    "freedom": "1",
    "windows": "1",
}
