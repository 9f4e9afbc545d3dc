# A fresh machine needs python3 (3.11 to 3.13), make and git; everything else goes into .venv.

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed
RL_BIN := .venv-rl/bin
RL_INSTALLED := .venv-rl/.installed
# By the oldest Python that pyproject.toml allows: otherwise by that of .venv, and older ones could not use the locks.
COMPILE := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --no-header --group dev

.DEFAULT_GOAL := help
.PHONY: help setup setup-rl demo bench corpus corpus-check test test-rl fuzz lock dist install-check

help:
	@echo "make setup  install the locked dependencies and manipuzzle itself into .venv"
	@echo "make demo   generate, convert, check, solve, verify and draw levels and puzzles into out/"
	@echo "make bench  time the parts, with peers beside them"
	@echo "make corpus  build data/corpus anew from the committed policies; corpus-check: build it elsewhere and compare"
	@echo "make test   lint, types and tests: what CI runs"
	@echo "make test-rl  the tests that need torch, in an environment of their own (.venv-rl)"
	@echo "make fuzz   search for inputs that make a parser fail, FUZZ_SECONDS=60 each"
	@echo "make lock   resolve the dependencies anew into the two lock files"
	@echo "make dist   wheel and sdist into dist/; install-check: install the wheel elsewhere and use it there"

setup: $(INSTALLED)

$(BIN)/uv:
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14) and \
	  "Python 3.11 to 3.13 is needed, for which OMPL has wheels; choose one by PYTHON=...")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet uv

# The stamp makes a second `make` start at once; a changed lock or project file installs again.
$(INSTALLED): pyproject.toml requirements.lock | $(BIN)/uv
	$(BIN)/uv pip sync --quiet --compile-bytecode --python $(BIN)/python --require-hashes requirements.lock
	$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --editable .
	touch $@

demo: setup
	$(BIN)/python -m evaluate.demo --out out

bench: setup
	$(BIN)/manipuzzle bench

corpus: setup
	$(BIN)/manipuzzle corpus build --out data/corpus

corpus-check: setup
	$(BIN)/manipuzzle corpus check data/corpus

test: setup
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m pytest -n 2 -m "not rl"

# The fuzzer lies in a folder of its own, so that setting up and testing need no download of it.
FUZZERS := out/fuzz/site
FUZZ_SECONDS ?= 60

$(FUZZERS): pyproject.toml | setup
	$(BIN)/uv pip install --quiet --python $(BIN)/python --target $@ --group fuzz
	touch $@

fuzz: $(FUZZERS)
	for parser in $$($(BIN)/python -c 'from tests.fuzz.parsers import PARSERS; print(*PARSERS)'); do \
	  PYTHONPATH=$(FUZZERS) $(BIN)/python -m tests.fuzz.coverage_guided $$parser --seconds $(FUZZ_SECONDS) || exit 1; \
	done

# torch has an environment of its own, so that setting up and testing the rest stays small.
setup-rl: $(RL_INSTALLED)

$(RL_INSTALLED): pyproject.toml requirements-rl.lock | $(BIN)/uv
	$(BIN)/uv venv --quiet --allow-existing --python $(BIN)/python .venv-rl
	$(BIN)/uv pip sync --quiet --python $(RL_BIN)/python --require-hashes requirements-rl.lock
	$(BIN)/uv pip install --quiet --python $(RL_BIN)/python --no-deps --editable .
	touch $@

test-rl: setup-rl
	$(RL_BIN)/python -m pytest -m rl

lock: $(BIN)/uv
	$(COMPILE) --extra cluster --output-file requirements.lock pyproject.toml
	$(COMPILE) --extra cluster --extra rl --output-file requirements-rl.lock pyproject.toml

dist: setup
	rm -rf dist
	$(BIN)/uv build --quiet --out-dir dist

# Without the checkout: the wheel alone in an environment of its own, used from an empty folder.
install-check: dist
	@set -e; work=$$(mktemp -d); trap 'rm -rf "$$work"' EXIT; \
	$(BIN)/uv venv --quiet --python $(BIN)/python "$$work/venv"; \
	$(BIN)/uv pip install --quiet --python "$$work/venv/bin/python" --constraints requirements.lock dist/*.whl; \
	cd "$$work"; PATH="$$work/venv/bin:$$PATH"; \
	if python -c 'import torch' 2>/dev/null; then echo 'torch is installed' >&2; exit 1; fi; \
	cp -r "$$(manipuzzle data)" data; \
	manipuzzle generate --agent m0 --count 2 --seed 1 --out levels; \
	manipuzzle convert levels --out scenes; \
	manipuzzle check scenes/*.yaml; \
	manipuzzle solve scenes/*.yaml data/puzzles/wall.yaml --out plans; \
	manipuzzle render plans/wall-*.json --format html --out pictures; \
	manipuzzle study data/studies/smoke.yaml --out study; \
	manipuzzle report study
