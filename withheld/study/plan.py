"""A case before anything is drawn for it, and with everything drawn."""

from dataclasses import dataclass

from withheld.chain.injector import World


@dataclass(frozen=True)
class Plan:
    """What a case is to be.

    Parameters
    ----------
    name : str
    kind : str
        As the protocol counts them: `single`, `pair`, ..., or a class of `withheld.study.classes`.
    effects : tuple of str
        What is wrong, as far as the plan says it.
    without : tuple of str
        Effects that the diagnoser is told to leave out.
    snr : float
        Target signal-to-noise ratio where the plan says it; 0 where it is drawn.
    """

    name: str
    kind: str
    effects: tuple[str, ...]
    without: tuple[str, ...]
    snr: float = 0.0


@dataclass(frozen=True)
class Drawn:
    """A campaign drawn for a plan.

    Parameters
    ----------
    design : str
    world : World
    roles : tuple of str
        For each of the world's entries what it is there for; empty where all are alike.
    seen : bool
        Whether the design shows what the plan asks for; else another one is drawn.
    """

    design: str
    world: World
    roles: tuple[str, ...] = ()
    seen: bool = True
