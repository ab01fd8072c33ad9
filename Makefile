# The codebase from one command: `make help`. Debian 12 with git and make is all that it needs to start.
#
# Work is skipped by stamps in build/: a second `make setup` takes a second. `make clean` begins again.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help setup render test lint sanitize fuzz bench accuracy stability gallery soak clean FORCE

PYTHON ?= python3
JOBS ?= $(shell nproc)
export CMAKE_BUILD_PARALLEL_LEVEL := $(JOBS)
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_NO_INPUT := 1

BIN := .venv/bin
BUILD := build/release
STAMPS := build/stamps
SYSTEM_PACKAGES := g++ cmake ninja-build python3 python3-venv python3-dev libtbb-dev libhwy-dev libosd-dev \
  libfmt-dev doctest-dev

CXX_SOURCES := $(shell find CMakeLists.txt cmake core delegate tests bench examples -name '*.h' -o -name '*.cpp' \
  -o -name CMakeLists.txt -o -name '*.cmake' -o -name '*.cmake.in' -o -name '*.h.in')
PYTHON_SOURCES := $(shell find delegate/usd/msbvh -name '*.py')
LINTERS := ruff==0.17.6 mypy==2.4.1 clang-format==16.0.6
PYTHON_FOLDERS := cmake delegate docs testenv tests/python bench examples
LONG_CASES := *every scene class*,a thousand lights*,*a million triangles*,a rotating edge*,a small disc out of focus*,the plane in focus*,degenerate sets build*,curves equal*,curves whose*,curves far*,points equal*
SHOWCASE := testenv/showcase/showcase.usda
SHOWCASE_TEXTURES := $(wildcard testenv/showcase/textures/*)
SHOWCASE_OPTIONS := --frames 6 --imageWidth 960 --spp 48

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## */make \1\t/p' Makefile | expand -t 16

setup: $(STAMPS)/installed  ## system packages if missing, .venv, build

$(STAMPS)/system: .ci/system_packages Makefile
	@.ci/system_packages $(SYSTEM_PACKAGES)
	@mkdir -p $(STAMPS) && touch $@

# A browser for the tests of HTML reports; rendering needs none. It comes after the other packages: Debian installs
# for one at a time.
$(STAMPS)/browser: .ci/system_packages Makefile | $(STAMPS)/system
	@command -v chromium chromium-browser google-chrome >/dev/null || .ci/system_packages chromium
	@mkdir -p $(STAMPS) && touch $@

# Counts instructions; for `make bench` alone.
$(STAMPS)/valgrind: .ci/system_packages Makefile
	@.ci/system_packages valgrind
	@mkdir -p $(STAMPS) && touch $@

# libFuzzer; for `make fuzz` and `make soak` alone.
$(STAMPS)/fuzzers: $(STAMPS)/installed .ci/system_packages pyproject.toml
	@.ci/system_packages clang-16 libclang-rt-16-dev
	@$(BIN)/pip install --quiet --no-build-isolation --config-settings=build-dir=$(BUILD) \
	  --config-settings=cmake.define.MSBVH_BUILD_TESTS=ON --config-settings=cmake.define.MSBVH_BUILD_BENCH=ON \
	  --editable '.[test,fuzz]'
	@touch $@

# What builds the package, once; what it needs to run comes with it.
$(STAMPS)/venv: $(STAMPS)/system
	@test -x $(BIN)/pip || $(PYTHON) -m venv .venv
	@$(BIN)/pip install --quiet 'scikit-build-core>=0.10' 'nanobind>=2.4' 'OpenImageIO==3.2.2.*'
	@touch $@

# Changes where a Python module comes, goes or moves: an editable installation knows where each one stands.
$(STAMPS)/modules: FORCE
	@mkdir -p $(STAMPS)
	@echo '$(sort $(PYTHON_SOURCES))' | cmp --silent - $@ || echo '$(sort $(PYTHON_SOURCES))' > $@

# One build tree holds the library, its tests, the bench and the Python extension; the package is installed editable.
$(STAMPS)/installed: $(STAMPS)/venv $(STAMPS)/modules pyproject.toml $(CXX_SOURCES)
	@echo 'Building with $(JOBS) jobs: minutes the first time.'
	@$(BIN)/pip install --quiet --no-build-isolation --config-settings=build-dir=$(BUILD) \
	  --config-settings=cmake.define.MSBVH_BUILD_TESTS=ON --config-settings=cmake.define.MSBVH_BUILD_BENCH=ON \
	  --editable '.[test]'
	@touch $@

render: out/showcase.exr out/showcase.png  ## the showcase scene, to out/showcase.exr and out/showcase.png

out/showcase.exr out/showcase.png &: $(SHOWCASE) $(SHOWCASE_TEXTURES) $(STAMPS)/installed $(PYTHON_SOURCES)
	@mkdir -p out
	@$(BIN)/msbvh record $(SHOWCASE) out/showcase.exr out/showcase.png $(SHOWCASE_OPTIONS)
	@echo 'Look at out/showcase.png'

# Both suites at once, the Python tests by as many processes as there are cores. Every test runs even where an earlier one
# fails; the C++ tests' output comes last.
test: setup $(STAMPS)/browser  ## every test: C++ (ctest) beside Python (pytest)
	@status=0; \
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error > build/ctest.log 2>&1 & ctest=$$!; \
	$(BIN)/pytest -n $(JOBS) --dist worksteal --durations 30 || status=$$?; \
	wait $$ctest || status=$$?; \
	cat build/ctest.log; \
	exit $$status

lint: setup  ## formatting of C++ and Python, ruff's rules, mypy's types
	@$(BIN)/pip install --quiet $(LINTERS)
	@$(BIN)/clang-format --dry-run --Werror $$(git ls-files '*.h' '*.cpp')
	@$(BIN)/ruff format --check $(PYTHON_FOLDERS)
	@$(BIN)/ruff check $(PYTHON_FOLDERS)
	@$(BIN)/mypy --python-executable $(BIN)/python

# The kernels for this machine's instruction set alone: compiling all of them with sanitizers takes far longer. The
# longest cases are left out, test_stability, which asks the kernels that test_property asks, and test_translate, whose code
# the fuzz targets run: `make soak` runs them.
sanitize: setup  ## a sample of the C++ tests under AddressSanitizer and UndefinedBehaviorSanitizer
	@cmake -S . -B build/sanitize -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO='-O1 -g1' \
	  -DMSBVH_SANITIZE=address,undefined -DMSBVH_NATIVE_KERNELS=ON > build/sanitize.log
	@cmake --build build/sanitize --target test_unit test_property test_render test_memory fuzz >> build/sanitize.log || \
	  { tail -n 60 build/sanitize.log; exit 1; }
	@printf '%s\n' render property unit memory | xargs -P $(JOBS) -I % env \
	  build/sanitize/tests/test_% --test-suite-exclude=slow --test-case-exclude='$(LONG_CASES)'
	@ctest --test-dir build/sanitize --output-on-failure --no-tests=error -R '^fuzz\.'

# OPTIONS: `--seconds N` for each target (60), `--only GLOB`, `--list`.
fuzz: setup $(STAMPS)/fuzzers  ## each fuzz target for a minute: libFuzzer on the core, atheris on the reader
	@$(BIN)/python docs/run_fuzz.py $(OPTIONS)

# Embree comes with the extra `bench`; where its wheel is missing the page has our figures alone. Needs a clean tree.
# OPTIONS: `--cycles` measures whole frames beside Cycles, in an environment that it makes (a GB).
bench: setup $(STAMPS)/valgrind  ## rays, builds, bytes, frames, effects on and off: to docs/performance.md, features.md, ablation.md
	@$(BIN)/pip install --quiet --no-build-isolation --config-settings=build-dir=$(BUILD) \
	  --config-settings=cmake.define.MSBVH_BUILD_TESTS=ON --config-settings=cmake.define.MSBVH_BUILD_BENCH=ON \
	  --editable '.[test,bench]'
	@$(BIN)/python docs/make_performance.py $(OPTIONS)
	@$(BIN)/python docs/make_features.py
	@$(BIN)/python docs/make_ablation.py

# Needs a clean tree. OPTIONS: `--reports DIR` makes the page of reports that are there.
accuracy: setup  ## what each step of accuracy costs on six scenes: to docs/accuracy.md; reports in out/accuracy
	@$(BIN)/pip install --quiet --no-build-isolation --config-settings=build-dir=$(BUILD) \
	  --config-settings=cmake.define.MSBVH_BUILD_TESTS=ON --config-settings=cmake.define.MSBVH_BUILD_BENCH=ON \
	  --editable '.[test,accuracy]'
	@$(BIN)/python docs/make_accuracy.py $(OPTIONS)

# Embree as in `make bench`. Needs a clean tree. OPTIONS: `--probes` or `--mutants` makes one section anew.
stability: setup  ## rays that get out of moving shapes, ours and Embree's, and deliberate defects: to docs/stability.md
	@$(BIN)/python docs/make_stability.py $(OPTIONS)

# OPTIONS: `--scenes FOLDER`, `--only GLOB`, `--again`. What is there already is not rendered again.
gallery: setup  ## the public scenes in ../shared/scenes, to one contact sheet: out/gallery/gallery.png
	@$(BIN)/python docs/make_gallery.py $(OPTIONS)

# Each check is remembered by commit: the same command goes on after an interruption. OPTIONS: `--list`, `--only GLOB`.
soak: setup $(STAMPS)/fuzzers  ## every long check whole, for hours; goes on where it was interrupted; result in docs/soak.md
	@$(BIN)/python docs/make_soak.py $(OPTIONS)

clean:  ## removes everything that make has made
	rm -rf build out .venv
