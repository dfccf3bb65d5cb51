# make demo    words to driven roads and pictures, from nothing but Python, pip and make
# make test    format, types and every test; ends with the ten dearest tests and the seconds it took
# make bench   the figures of benchmarks/        make docs    the site in site/
#              with SIZE=smallest: whether each of them runs
# make figures the outputs and pictures of README and docs, from the commands beside them
# make train   train the reader further, with OUT=folder TRAIN='--steps 2000': training/README.md
# make judges  ASAM's checker of OpenDRIVE, which wants an environment of its own; make test asks it
# make format  mend the format                   make clean   remove what make made
#
# Another Python: make test PYTHON=python3.12

PYTHON ?= python3
OUT ?= out
VENV ?= .venv
BIN := $(VENV)/bin
START := $(shell date +%s)
SECONDS_SO_FAR = $$(($$(date +%s) - $(START)))

FIND_VERSION := import sys; print("%d.%d" % sys.version_info[:2])
WANTED := $(shell $(PYTHON) -c '$(FIND_VERSION)' 2>/dev/null)
PIP := $(BIN)/python -m pip --disable-pip-version-check
INSTALL := $(PIP) install --quiet --constraint constraints.txt

.PHONY: help demo test bench docs figures judges train format clean
.DELETE_ON_ERROR:

help:
	@sed -n '/^# /s/^# //p;/^$$/q' Makefile

# The environment: one for everything; a wish for another Python makes it anew.
# Where Python comes without ensurepip, the pip at hand fills the environment.
$(VENV)/.python-$(WANTED):
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 15))' \
	  || { echo "make: needs Python 3.11 to 3.14, '$(PYTHON)' is '$(WANTED)'; say make PYTHON=python3.14"; exit 1; }
	@if [ "$$($(BIN)/python -c '$(FIND_VERSION)' 2>/dev/null)" != "$(WANTED)" ]; then \
	  echo "making $(VENV) with Python $(WANTED)"; \
	  $(PYTHON) -m venv --clear $(VENV) >/dev/null 2>&1 \
	  || { $(PYTHON) -m venv --clear --without-pip $(VENV) && $(PYTHON) -m pip --python $(BIN)/python install -q pip; }; \
	fi
	@touch $@

$(VENV)/.installed: $(VENV)/.python-$(WANTED) pyproject.toml constraints.txt
	@echo "installing RoadGPT into $(VENV)"
	@$(INSTALL) hatchling editables
	@$(INSTALL) --no-build-isolation --editable .
	@touch $@

$(VENV)/.installed-test $(VENV)/.installed-docs: $(VENV)/.installed-%: $(VENV)/.installed
	@echo "adding what '$*' needs"
	@$(INSTALL) --no-build-isolation --editable '.[$*]'
	@touch $@

demo: $(VENV)/.installed
	$(BIN)/roadgpt run "an uphill road with 3 turns" -n 3
	@echo "make demo: $(SECONDS_SO_FAR) s"
	@echo "Now call it with: $(BIN)/roadgpt run \"a winding road downhill\" -n 5"
	@echo "or once 'source $(BIN)/activate', then everywhere: roadgpt run ..."

# The simulator, the camera and the tests are compiled once, beside the check of types; each worker would do it anew.
test: export PYTHONDONTWRITEBYTECODE =
# More threads of BLAS than one, in three workers on two cores, spend their time waiting for each other.
test: export OPENBLAS_NUM_THREADS = 1
test: $(VENV)/.installed-test judges/.installed judges/.browser
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	{ $(BIN)/python -m roadgpt run "a road" --scene light --seed 1 --out "$$(mktemp -d)/compiled" && \
	  $(BIN)/python -m roadgpt run "a straight road of 25 m" --no-plot --out "$$(mktemp -d)/seen" \
	    --driver examples/vision/small_network.py:SmallNetwork; } > /dev/null & \
	  $(BIN)/python -m mypy && { $(BIN)/python -m pytest -q --collect-only > /dev/null || :; } && wait $$!
	$(BIN)/python -m pytest -n 3 --dist worksteal --durations 10
	@echo "make test: $(SECONDS_SO_FAR) s"

bench: $(VENV)/.installed-test
	@$(if $(filter smallest,$(SIZE)),grep '^bench_' benchmarks/smallest.txt,ls benchmarks | grep '^bench_') | while read -r line; do \
	  echo "== $$line"; $(BIN)/python benchmarks/$$line < /dev/null || exit 1; done
	@echo "make bench: $(SECONDS_SO_FAR) s"

# Not --quiet, with which --strict overlooks links that lead nowhere.
docs: $(VENV)/.installed-docs
	$(BIN)/python docs/commands.py
	$(BIN)/python docs/language.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict
	@echo "make docs: site/index.html, $(SECONDS_SO_FAR) s"

figures: $(VENV)/.installed-test
	@$(INSTALL) --no-build-isolation --editable '.[film]'
	rm -rf roadgpt-runs/figures
	$(BIN)/python docs/figures.py roadgpt-runs/figures
	@echo "make figures: $(SECONDS_SO_FAR) s"

train: $(VENV)/.installed-test
	$(INSTALL) -r training/requirements.txt
	cd training && ../$(BIN)/python -m roadgpt_training train $(OUT) --installed $(TRAIN)

judges: judges/.installed

# The browser of the tests of pages, which only root can install; elsewhere those tests are skipped, with the reason.
judges/.browser:
	@mkdir -p judges
	@if command -v chromium || command -v chromium-browser || command -v google-chrome; then :; \
	elif [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	  echo "installing chromium"; export DEBIAN_FRONTEND=noninteractive; \
	  { apt-get update && apt-get install --yes --no-install-recommends chromium; } >/dev/null 2>&1 \
	  || echo "chromium cannot be installed; tests in a browser are skipped"; \
	else echo "there is no chromium; tests in a browser are skipped"; fi
	@touch $@

# It wants a numpy below 2, so it has an environment of its own; for Python 3.13 there is no such numpy.
judges/.installed: $(VENV)/.python-$(WANTED)
	@mkdir -p judges
	@if $(PYTHON) -c 'import sys; sys.exit(sys.version_info >= (3, 13))'; then \
	  echo "adding ASAM's checker of OpenDRIVE in judges/venv-qc"; \
	  { $(PYTHON) -m venv --clear judges/venv-qc >/dev/null 2>&1 \
	  || { $(PYTHON) -m venv --clear --without-pip judges/venv-qc && $(PYTHON) -m pip --python judges/venv-qc/bin/python install -q pip; }; } \
	  && judges/venv-qc/bin/python -m pip --disable-pip-version-check install --quiet asam-qc-opendrive==1.0.0; \
	else echo "ASAM's checker of OpenDRIVE does not run on this Python; its tests are skipped"; fi
	@touch $@

format: $(VENV)/.installed-test
	$(BIN)/python -m ruff check --fix .
	$(BIN)/python -m ruff format .

clean:
	rm -rf $(VENV) judges build dist site .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find src tests benchmarks training -name __pycache__ -type d -prune -exec rm -rf {} +
