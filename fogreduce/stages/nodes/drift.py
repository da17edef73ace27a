"""Stage 6: the paper's offset rule and the integration."""

from __future__ import annotations

from fogreduce.errors import BadInput
from fogreduce.progress import Progress, silent
from fogreduce.stages.budget import BUDGET_COLUMNS, CORRELATIONS_COLUMNS, budget_of
from fogreduce.stages.budget_dataset import write_budget
from fogreduce.stages.drift import DRIFT_COLUMNS, RULE_COLUMNS, drift_rows, rule_rows
from fogreduce.stages.files import read_report
from fogreduce.stages.rates import RATES_COLUMNS, rate_rows
from fogreduce.stages.setup import Setup
from fogreduce.stages.tables import write_table


def run(setup: Setup, progress: Progress = silent) -> None:
    """The paper's offset rule and the integration; over at once, whatever the record's length."""
    fits = read_report(setup, "fit")
    complete_records = setup.complete_records
    try:
        budget = budget_of(setup.facts, setup.stated_errors, fits, setup.gyros, setup.axes)
        rows = drift_rows(setup.facts, fits, setup.axes, budget, setup.version_id)
        rules = rule_rows(fits, setup.axes, complete_records, setup.version_id)
        rates = rate_rows(setup.facts, setup.stated_errors, fits, setup.axes, budget, setup.version_id)
        parts = budget.rows(setup.version_id), budget.correlation_rows(setup.version_id)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        path = setup.out / "reports" / "fit.json"
        found = f"damage ({type(error).__name__}: {error})"
        raise BadInput.at(path, "", found=found, expected="the report as stage fit writes it") from None
    write_table(setup.table("drift"), DRIFT_COLUMNS, rows)
    write_table(setup.table("rates"), RATES_COLUMNS, rates)
    write_table(setup.table("drift_by_records"), RULE_COLUMNS, rules)
    write_table(setup.table("budget"), BUDGET_COLUMNS, parts[0])
    write_table(setup.table("correlations"), CORRELATIONS_COLUMNS, parts[1])
    write_budget(setup, budget)
