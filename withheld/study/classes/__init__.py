"""Classes of campaigns beyond one, two and three effects: benches as they are.

stale, stale_culprit   a unit that has aged since it was calibrated, alone and with something that happened
strong                 each effect far above the noise
link_slow              a link that loses or spoils readings, on a unit that drifts
mixed_quiet, mixed     runs of several rates and lengths, gyros of several grades
slow_log               below 2 Hz, coarse counts, spoilt readings
long_run               a single run of 100 minutes with one effect
near                   shapes near but not of the catalogue
"""

from withheld.study.classes.link_slow import LINK_SLOW
from withheld.study.classes.long_run import LONG_RUN
from withheld.study.classes.mixed import MIXED, MIXED_QUIET
from withheld.study.classes.model import CampaignClass
from withheld.study.classes.near import NEAR_SHAPES
from withheld.study.classes.slow_log import SLOW_LOG
from withheld.study.classes.stale import STALE, STALE_CULPRIT
from withheld.study.classes.strong import STRONG

CLASSES: dict[str, CampaignClass] = {
    "stale": STALE,
    "stale_culprit": STALE_CULPRIT,
    "strong": STRONG,
    "link_slow": LINK_SLOW,
    "mixed_quiet": MIXED_QUIET,
    "mixed": MIXED,
    "slow_log": SLOW_LOG,
    "long_run": LONG_RUN,
    "near": NEAR_SHAPES,
}
