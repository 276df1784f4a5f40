# A fresh clone needs one of: make demo, make test. Everything lands in .venv, build and demo.
PYTHON ?= python3
BIN := .venv/bin
CPP = $$(find core bindings tests/core -name '*.[hc]pp' -o -name '*.cu')
export OMP_WAIT_POLICY ?= passive
export PYVISTA_OFF_SCREEN ?= true

.PHONY: setup build dev check test validate coverage mutants benchmark torture sanitize portable package nightly verify lint format demo docs cuda emulated devices serial clean
.DEFAULT_GOAL := test

setup: .venv/installed

.venv/installed: pyproject.toml CMakeLists.txt tools/setup.sh
	PYTHON=$(PYTHON) tools/setup.sh
	touch $@

build: setup
	$(BIN)/python tools/build.py

# For work on the core: only the module for this CPU.
dev: setup
	$(BIN)/python tools/build.py --native

# The tests of one file: make check F=core/contact/force/contact_force.hpp
check: setup
	$(BIN)/python tools/check.py $(F)

# All tests, or with T=path (and any other words for pytest) some of those in Python. Folders of long
# tests go first: one that begins last would keep one processor busy and the others idle. Each
# process runs on one thread, as the others take the other processors.
LONG := tests/validation/ tests/integration/
ALL := -n auto --dist loadfile --no-loadscope-reorder $(LONG) $(filter-out $(LONG),$(wildcard tests/*/))
test: setup
	$(BIN)/python tools/build.py --own-laws $(if $(T),,--tests)
	$(if $(T),,build/core/core_tests)
	$(if $(T),,OMP_NUM_THREADS=1) $(BIN)/python -m pytest $(or $(T),$(ALL))

validate: build
	$(BIN)/python -m pytest -m slow

# Which lines of core/ and src/cdem/ the quick tests run. Where a test fills the disk, gcov's own line
# about it must not mix with what cdem says.
coverage: setup
	$(BIN)/python tools/build.py --coverage
	build/coverage/core_tests
	GCOV_ERROR_FILE=/dev/null OMP_NUM_THREADS=1 $(BIN)/python -m coverage run --source=cdem -m pytest tests/unit tests/integration tests/validation
	$(BIN)/python tools/build.py --native
	$(BIN)/python -m coverage report --sort=cover
	$(BIN)/python -m gcovr --delete --gcov-suspicious-hits-threshold 0 --filter core/ \
	  --sort uncovered-percent build/coverage

# Faults planted one by one must each fail a test; with T=name some of them. Cut off, it goes on from
# tools/mutant_list/known.json, on any machine, and renews docs/mutants.md.
mutants: setup
	$(BIN)/python tools/mutants.py --state tools/mutant_list/known.json --write $(T)

# Speeds at this commit on this machine, a point of docs/benchmark_history.jsonl.
benchmark: dev
	$(BIN)/python tools/benchmark_history.py

# What may happen to a run and to its input, in parts; see docs/results.md.
PARTS := damage cases files kills ranks small landslide faults-kill faults-EIO faults-ENOSPC
TORTURES := $(PARTS:%=torture-%)
STATE = --state build/torture/$(@:torture-%=%).json
.PHONY: $(TORTURES)
torture: $(TORTURES)

torture-damage: build
	$(BIN)/python tools/torture/damage.py $(STATE)

torture-cases: build
	$(BIN)/python tools/torture/fuzz.py cases 20000 --out build/torture/cases $(STATE)

torture-files: build
	$(BIN)/python tools/torture/fuzz.py files 10000 --out build/torture/files $(STATE)

torture-kills: build
	$(BIN)/python tools/torture/kills.py $(STATE)

torture-ranks: build
	$(BIN)/python tools/torture/ranks.py $(STATE)

torture-small torture-landslide: build
	$(BIN)/python tools/torture/soak.py $(@:torture-%=%) $(STATE)

torture-faults-kill torture-faults-EIO torture-faults-ENOSPC: build
	$(BIN)/python tools/torture/faults.py --how $(@:torture-faults-%=%) $(STATE)

# The tests of the core by clang: wrong accesses, undefined behaviour, races. Needs libomp.
sanitize: setup
	$(BIN)/python tools/build.py --sanitize address
	LD_PRELOAD=$$(clang++ -print-file-name=libclang_rt.asan-x86_64.so) ASAN_OPTIONS=detect_leaks=0 \
	  build/address/core_tests
	$(BIN)/python tools/build.py --sanitize thread
	OMP_NUM_THREADS=3 OMP_TOOL_LIBRARIES=$$(clang++ -print-resource-dir)/../../libarcher.so \
	  TSAN_OPTIONS=ignore_noninstrumented_modules=1 build/thread/core_tests

# As macOS would: by clang without OpenMP, the same bits; and the syntax by libc++ and for ARM.
portable: setup
	$(BIN)/python tools/portable.py

# The sdist, from it the wheel, installed where no clone is: sizes, a run, problems, a law built.
package: setup
	$(BIN)/python tools/try_package.py

nightly: test validate coverage mutants
	$(MAKE) emulated T=tests
	$(BIN)/cdem verify --full
	$(MAKE) portable
	$(MAKE) cuda

verify: dev
	$(BIN)/cdem verify --threads 1

lint: setup
	$(BIN)/ruff check src tests tools docs/_ext docs/conf.py
	$(BIN)/ruff format --check src tests tools docs/_ext docs/conf.py
	$(BIN)/clang-format --dry-run -Werror $(CPP)
	$(BIN)/python tools/layers.py
	$(BIN)/python tools/members.py
	$(BIN)/python tools/mutants.py --check
	$(BIN)/python tools/package_layers.py
	$(BIN)/python tools/package_files.py
	$(BIN)/python tools/drawing.py --check
	$(BIN)/python tools/walks.py --check
	$(BIN)/python tools/links.py
	$(BIN)/mypy src/cdem
	$(BIN)/lizard -L 60 -C 15 -w core src/cdem tools docs/_ext
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/zizmor --quiet --offline .github
	$(BIN)/codespell README.md CHANGELOG.md CONTRIBUTING.md core bindings src tests docs tools

format: setup
	$(BIN)/ruff check --fix src tests tools docs/_ext docs/conf.py
	$(BIN)/ruff format src tests tools docs/_ext docs/conf.py
	$(BIN)/clang-format -i $(CPP)

demo: dev
	mkdir -p demo
	$(BIN)/cdem new landslide demo --overwrite
	$(BIN)/cdem run demo/landslide.yaml -o demo/landslide.results --overwrite
	$(BIN)/cdem plot demo/landslide.results
	$(BIN)/cdem render demo/landslide.results
	$(BIN)/cdem info demo/landslide.results
	@echo "Pictures, histories and summary are in demo/landslide.results"

# The site, in build/docs: every page, notebooks run, references made from the code.
docs: dev
	$(BIN)/python -m sphinx -q -E -W --keep-going -b html docs build/docs
	@echo "open build/docs/index.html"

# The core for a GPU: registers, spills and loads of its kernels; needs nvcc. Where there is a GPU the
# tests of the core and the golden scenes run on it. With PTX=1 the checks alone, in half the time.
cuda: setup
	$(BIN)/python tools/cuda.py $(if $(PTX),--ptx)

# What a GPU would not forgive, looked for on the CPU: the tests of the core, and the golden scenes
# that take a second or two, or with T=path those tests in Python.
QUICK := tests/regression/test_golden.py \
  -k "pinned and not (3 or landslide or rubble or defaults or flowing or leaving)"
emulated: setup
	$(BIN)/python tools/build.py --emulated
	build/emulated/core_tests
	CDEM_ISA=emulated OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto $(or $(T),$(QUICK))

# What the host does between the launches of a step; RUN="CASE FOLDER": of a run that goes on.
devices: setup
	$(BIN)/python tools/build.py --emulated
	CDEM_ISA=emulated CDEM_EMULATED_HOST=count OMP_NUM_THREADS=1 $(BIN)/python tools/devices.py $(RUN)

# How far threads could speed up a step: what runs on one of them only.
serial: build
	$(BIN)/python tools/serial.py

clean:
	rm -rf .venv build demo
