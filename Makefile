# make demo   set up, run the paper's Figure 4 cell, leave data and pictures in results/
# make explore   set up, open a living cell in the browser
# make test   set up, run the tests and the style and type checks
# make check  the slower physics checks, and those of the page's parts where there is npm
# make coverage   lines and branches that the tests of `make test` run, part by part, in docs/quality.md
# make docs   build the site of these pages in docs/_build/html; every page with code is run
# make page   build the explorer's page anew (needs Node.js 20.19 or newer); setting up does so where it can
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/python -m pip install --quiet --disable-pip-version-check
PAGE   := src/cyclosis/explorer/page/index.html
NODE   := install Node.js 20.19 or newer, then run \`make page\`
# What the page is made of, as hatch_build.py sees it.
WEB    := $(shell find web -type f -not -path 'web/node_modules/*' -not -path 'web/tests/*' -not -path 'web/dist/*' -not -path '*/.*' 2>/dev/null)

# Two processes test side by side: with threads of linear algebra besides, each would wait for the other.
ALONE  := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

.PHONY: demo explore test check coverage lint docs page clean

demo: $(VENV)/installed
	@mkdir -p results
	@echo "1 of 3: computing the cell of Figure 4 up to t = 200 ..."
	@$(BIN)/cyclosis run --config examples/figure4.toml --out results/figure4.nc --force
	@echo "2 of 3: drawing Figure 4 and the history of the run ..."
	@$(BIN)/cyclosis figure emergence results/figure4.nc --out results/figure4.png --force
	@$(BIN)/cyclosis figure history results/figure4.nc --out results/figure4-history.png --force
	@echo "3 of 3: drawing the movie ..."
	@$(BIN)/cyclosis movie results/figure4.nc --force
	@echo "Look at results/figure4.png first. \`make explore\` opens a living cell in the browser."

explore: $(VENV)/installed
	@$(BIN)/cyclosis explore

test: $(VENV)/tested lint
	$(ALONE) $(BIN)/python -m pytest -n 2 -m "not slow"

check: $(VENV)/tested
	$(ALONE) $(BIN)/python -m pytest -n 2 -m "slow and not browser"
	$(ALONE) $(BIN)/python -m pytest -n 2 --dist loadfile -m browser
	@if command -v npm >/dev/null; then cd web && npm ci --silent && npm test; \
	else echo "The tests of the page's parts are skipped: there is no npm."; fi

coverage: $(VENV)/tested
	$(BIN)/python -m pytest -n 2 -m "not slow" --cov --cov-branch --cov-report=term --cov-report=json:.coverage.json
	$(BIN)/python benchmarks/quality.py .coverage.json

lint: $(VENV)/tested
	$(BIN)/ruff check .
	$(BIN)/mypy

docs: $(VENV)/documented
	$(BIN)/python docs/generate.py
	$(BIN)/sphinx-build -W --keep-going -q -j auto docs docs/_build/html
	@echo "Open docs/_build/html/index.html"

$(VENV)/documented: $(VENV)/installed
	@echo "Installing what the documentation needs ..."
	@$(PIP) --editable ".[docs]"
	@touch $@

$(VENV)/installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("cyclosis needs Python 3.11 or newer, this is " + sys.version.split()[0] + ": set PYTHON=/path/to/python3.11") if sys.version_info < (3, 11) else None'
	@echo "Installing cyclosis and what it needs into $(VENV)/: 1 GB, about a minute ..."
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) --editable .
	@test -f $(PAGE) || echo "The explorer's page is not there: $(NODE)." >&2
	@touch $@

$(VENV)/tested: $(VENV)/installed
	@echo "Installing what the tests need ..."
	@$(PIP) --editable ".[test]"
	@touch $@

page: $(PAGE)

$(PAGE): $(WEB)
	@command -v npm >/dev/null || { echo "There is no npm: $(NODE)." >&2; exit 1; }
	cd web && npm ci && npm run build
	@touch $@

clean:
	rm -rf $(VENV) results dist build docs/_build web/node_modules $(dir $(PAGE))
