# The two commands of the README: `make reduce` and `make test`. Both need only Python, pip, git and make.

PYTHON ?= python3
VENV ?= .venv
CORES ?= 2
BIN := $(VENV)/bin
READY := $(VENV)/.installed
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: reduce test test-slow lint install clean

## Reduce the bundled campaigns from raw bytes to datasets, tables and figures, into results/.
reduce: $(READY)
	$(BIN)/snakemake --cores $(CORES)

## Run the tests.
test: $(READY)
	$(BIN)/python -m pytest -n $(CORES) --dist loadfile

## Run the tests that take longer.
test-slow: $(READY)
	$(BIN)/python -m pytest -m slow

## Check style, types and the workflow.
lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/python workflow/lint.py

## Make the virtual environment with the pinned dependencies.
install: $(READY)

$(READY): requirements.lock pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
		--config-settings editable_mode=compat -e .
	touch $@

clean:
	rm -rf $(VENV) .snakemake results/[!R]*
