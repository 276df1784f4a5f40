# A fresh clone needs one of: make demo, make test. Everything lands in .venv, build and demo.
PYTHON ?= python3
BIN := .venv/bin
export OMP_WAIT_POLICY ?= passive
export PYVISTA_OFF_SCREEN ?= true

.PHONY: setup test validate verify lint format demo cuda clean
.DEFAULT_GOAL := test

setup: .venv/installed

.venv/installed: pyproject.toml CMakeLists.txt $(shell find core bindings -name '*.[hc]*')
	PYTHON=$(PYTHON) tools/setup.sh
	touch $@

test: setup
	$(BIN)/python -m pytest

validate: setup
	$(BIN)/python -m pytest -m slow

verify: setup
	$(BIN)/cdem verify

lint: setup
	$(BIN)/ruff check src tests tools
	$(BIN)/ruff format --check src tests tools
	$(BIN)/clang-format --dry-run -Werror $$(find core bindings -name '*.[hc]pp' -o -name '*.cu')
	$(BIN)/python tools/layers.py
	$(BIN)/python tools/package_layers.py
	$(BIN)/mypy src/cdem
	$(BIN)/lizard -L 60 -C 15 -w core src/cdem tools
	$(BIN)/codespell README.md CHANGELOG.md CONTRIBUTING.md core bindings src tests docs tools

format: setup
	$(BIN)/ruff check --fix src tests tools
	$(BIN)/ruff format src tests tools
	$(BIN)/clang-format -i $$(find core bindings -name '*.[hc]pp' -o -name '*.cu')

demo: setup
	mkdir -p demo
	$(BIN)/cdem new landslide demo --force
	$(BIN)/cdem run demo/landslide.yaml -o demo/landslide.results --overwrite
	$(BIN)/cdem plot demo/landslide.results
	$(BIN)/cdem render demo/landslide.results
	$(BIN)/cdem info demo/landslide.results
	@echo "Pictures, histories and summary are in demo/landslide.results"

cuda: setup
	tools/cuda.sh

clean:
	rm -rf .venv build demo
