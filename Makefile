# make demo   set up, run the paper's Figure 4 cell, leave data and pictures in results/
# make test   set up, run the tests and the style and type checks
# make check  the slower physics checks
# make page   build the explorer's page anew (needs Node.js 20.19 or newer); setting up does so where it can
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
PAGE   := src/cyclosis/explorer/page/index.html
NODE   := install Node.js 20.19 or newer, then run \`make page\`
# What the page is made of, as hatch_build.py sees it.
WEB    := $(shell find web -type f -not -path 'web/node_modules/*' -not -path 'web/tests/*' -not -path 'web/dist/*' -not -path '*/.*' 2>/dev/null)

.PHONY: demo test check lint page clean

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
	@test -f $(PAGE) || echo "The explorer's page is not there: $(NODE)." >&2
	@touch $@

page: $(PAGE)

$(PAGE): $(WEB)
	@command -v npm >/dev/null || { echo "There is no npm: $(NODE)." >&2; exit 1; }
	cd web && npm ci && npm run build
	@touch $@

clean:
	rm -rf $(VENV) results dist build web/node_modules $(dir $(PAGE))
