"""The prior over sets: it is a probability, and what it prefers."""

from __future__ import annotations

from math import comb, exp, log

import pytest

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.hierarchy import Kind, log_places, log_prior

OFFSET, SCALE = Kind("bias_offset", 4, True), Kind("scale_factor_error", 4, True)
CROSSTALK, MOUNT = Kind("crosstalk", 12, False), Kind("mount_rotation", 1, True)


@pytest.mark.parametrize("kind", [OFFSET, CROSSTALK, MOUNT])
def test_all_sets_of_a_kinds_places_sum_to_one(kind: Kind) -> None:
    whole = sum(comb(kind.places, n) * exp(log_places(kind, n)) for n in range(kind.places + 1))
    assert whole == pytest.approx(1.0, rel=1e-12)


def test_all_sets_of_two_kinds_of_a_record_sum_to_one() -> None:
    kinds = [OFFSET, SCALE]
    whole = sum(
        comb(4, a) * comb(4, b) * exp(log_prior(kinds, {OFFSET: a, SCALE: b}))
        for a in range(5)
        for b in range(5)
    )
    assert whole == pytest.approx(1.0, rel=1e-12)


def test_one_place_alone_has_half_of_its_kind() -> None:
    """Four places: half the kind's probability on single ones, and the law's part; by hand for a = 2, b = 1:
    BB(1; 4) = 4 B(3, 4) / B(2, 1) = 4 (1/60) / (1/2) = 2/15, BB(0; 4) = B(2, 5) / B(2, 1) = 1/15.
    """
    by_hand = priors.KIND * (0.5 / 4 + 0.5 * (2 / 15 / 4) / (1 - 1 / 15))
    assert log_places(OFFSET, 1) == pytest.approx(log(by_hand), rel=1e-12)


def test_a_fourth_gyro_costs_less_than_the_first() -> None:
    kinds = [OFFSET, MOUNT]

    def price(n: int) -> float:
        return log_prior(kinds, {OFFSET: n}) - log_prior(kinds, {OFFSET: n - 1})

    assert price(4) > price(3) > price(1)


def test_a_stale_record_makes_a_further_kind_of_it_likely_and_no_other() -> None:
    kinds = [OFFSET, SCALE, CROSSTALK]
    alone = log_prior(kinds, {SCALE: 4}) - log_prior(kinds, {})
    beside = log_prior(kinds, {OFFSET: 4, SCALE: 4}) - log_prior(kinds, {OFFSET: 4})
    assert beside > alone + 1.0
    other = log_prior(kinds, {OFFSET: 4, CROSSTALK: 1}) - log_prior(kinds, {OFFSET: 4})
    assert other == pytest.approx(log_prior(kinds, {CROSSTALK: 1}) - log_prior(kinds, {}), abs=1e-9)
