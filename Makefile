# make demo and make test need Python 3.11+ (with venv), make and the network, nothing else.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Exact versions for everything, the build backend included.
export PIP_CONSTRAINT := $(CURDIR)/constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# What the compiled kernels are made of: after a change they are compiled again.
KERNELS := hatch_build.py $(wildcard alpha5_model/kernels/*.[ch] alpha5_model/kernels/generated/*.h)

.PHONY: demo test test-all docs lint format benchmark conformance lowest fuzz clean

demo: $(VENV)/.demo ## generates, checks, solves and computes once; ends with a picture page
	$(BIN)/alpha5 demo

PYTEST := $(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist loadfile

test: $(VENV)/.test ## the fast tests; they need nothing else on the machine
	$(PYTEST) -m "not slow and not browser and not tools"

test-all: $(VENV)/.test ## every test that can run with what is installed
	$(PYTEST)

docs: $(VENV)/.docs ## the documentation, build/docs/index.html (1.6 GB of packages); a warning or a dead link is an error
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet docs build/docs

lint: $(VENV)/.test ## ruff (lint and format), mypy in strict mode, layers of imports, dependencies
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/deptry alpha5_model

format: $(VENV)/.test
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

benchmark: $(VENV)/.bench ## ratios against other packages, measured in one run, into docs/speed.md
	$(BIN)/python scripts/benchmarks/benchmark.py --page docs/speed.md

conformance: $(VENV)/.conformance ## every tool on the generated files, one table, into the documentation
	$(BIN)/python scripts/conformance/conformance.py --readme docs/conformance.md
	bash scripts/conformance/real_tools.sh $(BIN)/python --page docs/conformance.md

lowest: $(VENV)/.test ## the tests with the lowest versions that pyproject.toml declares
	bash scripts/checks/lowest_versions.sh $(BIN)/uv

fuzz: $(VENV)/.test ## thousands of inputs to the package, its readers and its command line, other ones each time
	ALPHA5_FUZZ_EXAMPLES=5000 $(PYTEST) tests/fuzz

clean:
	rm -rf $(VENV) build dist demo

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.demo: pyproject.toml constraints.txt $(KERNELS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[plot]'
	touch $@

$(VENV)/.test: pyproject.toml constraints.txt $(KERNELS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[test,lint]'
	touch $@ $(VENV)/.demo

$(VENV)/.docs: pyproject.toml constraints.txt | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	touch $@

$(VENV)/.bench: pyproject.toml constraints.txt $(KERNELS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[bench]'
	touch $@

$(VENV)/.conformance: pyproject.toml constraints.txt $(KERNELS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[conformance]'
	touch $@
