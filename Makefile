# Everything happens in a virtual environment of its own, made on first use.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
INSTALL ?= $(BIN)/python -m pip install --quiet --disable-pip-version-check
# Neighbouring tests often share machine code: each worker gets half of them, and then from who has most left.
TWO := -n 2 --dist worksteal --durations=25

.PHONY: tournament test slow check bench clean
.DELETE_ON_ERROR:

tournament: $(VENV)/.installed  ## the paper's tournament: tables on the screen, results in runs/paper.sqlite
	$(BIN)/arena run paper

test: $(VENV)/.test  ## the fast tests
	$(BIN)/python -m pytest -m fast $(TWO)

slow: $(VENV)/.test  ## all others, those that measure time last and alone
	$(BIN)/python -m pytest -m "not fast and not timing" $(TWO)
	$(BIN)/python -m pytest -m timing -n 0 --durations=25

check: $(VENV)/.dev  ## format, lint, types, rooms, and the fast tests with their coverage
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
	$(INSTALL) --editable .
	touch $@

$(VENV)/.test: $(VENV)/.created pyproject.toml
	$(INSTALL) --editable '.[test]'
	touch $@

$(VENV)/.dev: $(VENV)/.created pyproject.toml
	$(INSTALL) --editable '.[dev]'
	touch $@
