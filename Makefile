# make demo   set up, run the paper's Figure 4 cell, leave data and pictures in results/
# make test   set up, run the tests and the style and type checks
# make check  the slower physics checks
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin

.PHONY: demo test check lint clean

demo: $(VENV)/installed
	@mkdir -p results
	@$(BIN)/cyclosis run --config examples/figure4.toml --out results/figure4.nc --force
	@$(BIN)/cyclosis figure emergence results/figure4.nc --out results/figure4.png --force
	@$(BIN)/cyclosis figure history results/figure4.nc --out results/figure4-history.png --force
	@$(BIN)/cyclosis movie results/figure4.nc --force

test: $(VENV)/installed lint
	$(BIN)/python -m pytest -n 2 -m "not slow"

check: $(VENV)/installed
	$(BIN)/python -m pytest -m slow

lint: $(VENV)/installed
	$(BIN)/ruff check .
	$(BIN)/mypy

$(VENV)/installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit("cyclosis needs Python 3.11 or newer, this is " + sys.version.split()[0] + ": set PYTHON=/path/to/python3.11") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[test]"
	@touch $@

clean:
	rm -rf $(VENV) results dist build
