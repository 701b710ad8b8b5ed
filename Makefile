# Everything happens in a virtual environment of its own, made on first use.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

.PHONY: tournament test slow check bench clean
.DELETE_ON_ERROR:

tournament: $(VENV)/.installed  ## the paper's tournament: tables on the screen, results in runs/paper.sqlite
	$(BIN)/arena run paper

test: $(VENV)/.test  ## all but the slow tests
	$(BIN)/python -m pytest -m "not slow" -n 2

slow: $(VENV)/.test  ## the slow tests
	$(BIN)/python -m pytest -m slow

check: $(VENV)/.dev  ## what CI runs: format, lint, types, rooms, tests
	$(BIN)/python scripts/check

bench: $(VENV)/.installed  ## the compiled learning loop beside the same loop written by hand
	$(BIN)/python scripts/bench_learning.py

clean:  ## remove the virtual environment
	rm -rf $(VENV)

$(VENV)/.created:
	@$(PYTHON) -c 'import sys; sys.exit(None if sys.version_info >= (3, 11) else \
	"This needs Python 3.11 or newer; name one: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.installed: $(VENV)/.created pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.test: $(VENV)/.created pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	touch $@

$(VENV)/.dev: $(VENV)/.created pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@
