"""Every prior of the search over sets of causes, with its reason.

Sizes themselves are priors of the effects: the realistic range that each parameter states
(`fogreduce.effects.model.Parameter`), with its source in the effect's entry.
"""

from __future__ import annotations

import numpy as np

from fogreduce.effects.table import EFFECTS

#: That a kind of effect is present at all. Forty kinds of this probability make a bench right in three of
#: four campaigns, and one kind wrong in most of the others.
KIND = 0.0075

#: Given the kind, that it sits at one place alone; otherwise any number of places, by a beta-binomial law:
#: what ages at one gyro ages at the others (IEEE Std 952 states repeatabilities for a type, not for a unit).
SINGLE = 0.5
#: Shapes of that law: of effects of every run, and of those of a single run or pair of gyros, which are
#: rarely at many places.
EVERY_GYRO, SOME_PLACES = (2.0, 1.0), (1.0, 3.0)

#: That the calibration record as a whole has gone stale, what it states, how likely each of that is then, and
#: the law of how many gyros have it.
STALE, OF_RECORD = 0.03, frozenset(name for name, effect in EFFECTS.items() if effect.of_record)
STALE_KIND, STALE_GYROS = 0.6, (4.0, 1.0)

#: Ln odds before the spectra were seen: that one line more is there, as one of forty effects; that two lines
#: of one gyro mix, which no effect of the catalogue makes.
A_LINE, A_MIXTURE = np.log(0.1 / 40.0), np.log(0.01 * 0.3 / 12.0)

#: That all gyros are off by one common amount, beside amounts of their own.
COMMON = 0.05

#: Standard deviations of an amplitude, as factors of the ends of its realistic range, and their weights.
#: Below the range effects are there but hardly seen; above it each decade is ten times rarer: Cauchy's tail,
#: which Gelman (2006, Bayesian Analysis 1, 515) advises for scales of which only an order is known.
BELOW = ((0.03, 0.03), (0.1, 0.05), (0.3, 0.1))
ABOVE = ((3.0, 0.1), (10.0, 0.04), (100.0, 0.004))
#: No size beyond so many standard deviations of the widest scale is believed: a crosstalk or a scale factor
#: off by more than a tenth are other faults than what these names mean.
LARGEST = 1.0
WITHIN, WITHIN_WEIGHT = 5, 0.663

#: Sets whose posterior falls short of the best one's by more than this factor are left out (Occam's window,
#: Madigan and Raftery 1994, who take 20; groups of rivals need a wider one).
WINDOW = np.log(1000.0)

#: Rivals in a group are within this factor of the best of them.
RIVAL = np.log(150.0)

#: Signal-to-noise ratio from which a cause goes into the chain before others are looked for: a hundredth of
#: it, as causes change each other's doing, would show.
GROSS = 150.0

#: The same of a whole gap, beyond which it is left to the search for few causes: what few causes leave of it
#: draws sets of many that add up to it and are not there.
GROSS_GAP = 1000.0

#: Ln evidence beside the others from which the runs speak for a cause: 20, 'strong' (Kass and Raftery 1995).
#: What the prior alone makes likely, since other gyros have it, is not judged present.
SPEAKS = np.log(20.0)

#: Ln odds against something unknown that does just what effects of the catalogue do.
AS_WELL = np.log(10.0)

#: The closure that the 95 % interval must reach for a gap to be called explained (the diagnosis contract).
CLOSED = 0.97

#: What is left stands out where noise alone would do so in less than one of so many: a test's usual level.
REMAINDER = 0.01

#: How far an effect's shape may be from the catalogue's, relative to its size: what its formula idealises;
#: and where a temperature drives it, whose coil lags behind its sensor.
DEPARTURE, WARM_DEPARTURE = 0.08, 0.15

#: Ln prior odds of a gap at all, an even chance for every second bench being well; of one cause more beside
#: others; of something unknown, any family of it.
LOG_GAP, LOG_FURTHER, LOG_UNKNOWN = np.log(0.3 / 0.7), np.log(0.1), np.log(0.1)
#: Effects, and families of the unknown, that share those evenly.
NAMES, FAMILIES = 40.0, 12.0
#: Ln of odds against what an effect's parameters do not allow.
IMPOSSIBLE = 50.0

#: What a cause may change of a spectrum's pieces, in noise of one sample, and leave it as it is.
BENT = 1.0

#: How long a bias may take to step, beside not at all [s]: a supply or a light source that settles.
RISE_S = (0.25, 0.5, 1.0, 2.0, 4.0)

#: Campaigns simulated with the causes in them; and how much more than theirs a measured statistic must show:
#: of a random cause the largest of two draws with ten degrees is exceeded by half in one of a hundred.
SIMULATED, AS_SIMULATED = 2, 1.5
