"""Classes of campaigns beyond one, two and three effects: benches as they are.

stale, stale_culprit   a unit that has aged since it was calibrated, alone and with something that happened
strong                 each effect far above the noise
"""

from withheld.study.classes.model import CampaignClass
from withheld.study.classes.stale import STALE, STALE_CULPRIT
from withheld.study.classes.strong import STRONG

CLASSES: dict[str, CampaignClass] = {
    "stale": STALE,
    "stale_culprit": STALE_CULPRIT,
    "strong": STRONG,
}
