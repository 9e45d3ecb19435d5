# make        build everything: the core, and in each Python environment the package; .venv/bin/stormfield works
# make zip    the extension for Blender on any Linux, in out/: ten minutes the first time
# make demo   render the storm merge to PNG frames and a video
# make test   all tests and checks, under every Blender that is found
# make test-zip   the zip on a clean machine: installed, used, removed; a part of make test
# make test-threads  the C++ tests under the thread sanitizer
# make test-long     the long versions of the C++ tests: finer meshes, more samples, more random designs
# make bench  benchmarks; they print ratios
# make lint   formatting, ruff, mypy (which knows the core by its stubs)
# make docs   the documentation, in build/docs/html; warnings are errors
SHELL := /bin/bash
.DELETE_ON_ERROR:
JOBS ?= $(shell nproc)
PYTHON := .venv/bin/python
# Clones in different places share what ccache holds.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := 1
export CCACHE_SLOPPINESS := pch_defines,time_macros
# For a core that is compiled from nothing; one that is there stays as it is.
FIRST_BUILD = $(if $(wildcard build/release/CMakeCache.txt),,-DSTORMFIELD_PRECOMPILED=ON)
# The packages of an extra of pyproject.toml.
extra = $$(python3 -c "import re; \
  print(*re.findall(r'\"([^\"]+)\"', re.search(r'^$(1) = \[(.*)\]', open('pyproject.toml').read(), re.M).group(1)))")
ENVIRONMENTS = $(shell scripts/environments.sh list)
# Where scripts/build_tools.sh puts a CMake that is new enough, if the system's is not.
export PATH := $(CURDIR)/build/tools/bin:$(PATH)
# Clang is for tests alone, and not every release has the one that they use.
CLANG := clang-19
# The wheels of the zip are built from oneTBB's source and Python's headers as Debian's servers have them.
IS_DEBIAN := $(shell . /etc/os-release && [ "$$ID" = debian ] && echo yes)
HAS_CLANG = $(shell command -v clang++-19 || apt-cache search --names-only '^$(CLANG)$$' 2>/dev/null)

core_sources := $(shell find native cmake CMakeLists.txt CMakePresets.json -type f)
addon_sources := $(shell find addon -type f -not -path '*/__pycache__/*')

.PHONY: all zip demo test test-zip test-native test-odr test-results test-threads test-long test-python bench lint docs clean
all: build/.installed

build/.packages: scripts/debian_packages.sh
	@mkdir -p build
	@scripts/debian_packages.sh
	@touch $@

build/.tools: build/.packages scripts/build_tools.sh CMakeLists.txt
	@scripts/build_tools.sh
	@touch $@

build/.packages-clang: build/.packages
	@scripts/debian_packages.sh $(CLANG)
	@touch $@

build/.environments: build/.packages scripts/environments.sh pyproject.toml
	@scripts/environments.sh create >/dev/null
	@touch $@

build/.core: build/.tools $(core_sources)
	@scripts/step.sh configure "looking for compiler and libraries" cmake --preset release $(FIRST_BUILD)
	@scripts/step.sh --live core "compiling the core: about four minutes on two cores the first time" \
	  cmake --build --preset release -j $(JOBS) --target core
	@touch $@

# The core is compiled once, for its tests too; only the bindings are compiled for each Python. Compiling and
# downloading do not wait for each other.
build/.installed: build/.tools $(core_sources) scripts/environments.sh $(addon_sources) pyproject.toml README.md
	@$(MAKE) --no-print-directory -j 2 build/.core build/.environments
	@set -e; for environment in $(ENVIRONMENTS); do \
	  scripts/step.sh install$$environment "compiling Stormfield's Python module for $$environment: half a minute" \
	  $$environment/bin/python -m pip install --no-deps --no-build-isolation --force-reinstall \
	    -C cmake.define.STORMFIELD_CORE_DIR=$(CURDIR)/build/release . ; \
	done
	@mkdir -p build/stubs
	@cp .venv/lib/python*/site-packages/stormfield_native-stubs/__init__.pyi build/stubs/stormfield_native.pyi
	@touch $@

zip: build/.environments
	@scripts/step.sh wheels "compiling for the Python of every Blender: ten minutes the first time, seconds later" \
	  $(PYTHON) scripts/build_wheels.py --output out/wheels
	@$(PYTHON) scripts/build_extension.py --output out
	@echo "Install it in Blender: Edit, Preferences, Get Extensions, the arrow at the upper right, Install from Disk"

demo: all
	$(PYTHON) blend_examples/demo.py

test: lint test-native test-python $(if $(IS_DEBIAN),test-zip) docs
	@$(if $(IS_DEBIAN),,echo "The zip is built on Debian: its test was left out")

# As they ship, as they ship on a processor without AVX2, compiled by Clang, and under the address and undefined behaviour
# sanitizers; ccache shares what the first two have in common.
NATIVE_BUILDS = release baseline $(if $(HAS_CLANG),clang) asan
test-native: $(addprefix test-native-,$(NATIVE_BUILDS)) test-results test-odr
	@$(if $(HAS_CLANG),,echo "$(CLANG) is not among this system's packages: the build by Clang was left out")

test-native-clang: build/.packages-clang

test-native-%: build/.tools
	cmake --preset $*
	cmake --build --preset $* -j $(JOBS)
	ctest --preset $* -j $(JOBS)

# The same computations give the same bits in every build.
test-results: $(addprefix test-native-,$(NATIVE_BUILDS))
	@set -e; for build in $(NATIVE_BUILDS); do \
	  build/$$build/tests/native/print_results >build/$$build/results.txt; \
	  diff build/release/results.txt build/$$build/results.txt || { echo "$$build gives other results than release"; exit 1; }; \
	done; echo "the same results: $(NATIVE_BUILDS)"

test-odr: build/.tools
	cmake --preset odr
	cmake --build --preset odr -j $(JOBS)

# Debian's oneTBB is not instrumented, and nearly every test would drown in false reports.
test-threads: build/.tools
	scripts/build_onetbb.sh thread build/onetbb/thread
	$(MAKE) --no-print-directory test-native-tsan

test-long: build/.tools
	cmake --preset release
	cmake --build --preset release -j $(JOBS)
	@set -e; for program in build/release/tests/native/test_*; do \
	  [ -x $$program ] && [ -f $$program ] || continue; \
	  STORMFIELD_LONG_TESTS=1 $$program --gtest_brief=1; \
	done

# Both Blenders at once; what they print stays together.
test-python: all
	@$(MAKE) --no-print-directory --output-sync=target -j $(JOBS) $(addprefix test-python-in-,$(ENVIRONMENTS))

test-python-in-%:
	@echo "tests under $*"; $*/bin/python -m pytest tests

# The zip in a system of its own that has Blender and nothing else.
test-zip: all zip
	@set -e; for environment in $(ENVIRONMENTS); do \
	  echo "the zip on a clean machine with the Blender of $$environment"; \
	  STORMFIELD_ZIP=$$(ls -t out/stormfield-*-linux_x64.zip | head -n 1) $$environment/bin/python -m pytest tests/clean_machine; \
	done

bench: all
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target bench_native
	build/release/tests/native/bench_native
	$(PYTHON) -m pytest -p no:cacheprovider --rootdir tests/benchmarks -s tests/benchmarks

build/.lint: pyproject.toml
	@mkdir -p build
	python3 -m venv .venv-lint
	.venv-lint/bin/python -m pip install --quiet $(call extra,lint)
	@touch $@

# mypy reads the stubs of the core that `all` leaves in build/stubs.
lint: all build/.lint
	find native tests -name '*.h' -o -name '*.cpp' | xargs .venv-lint/bin/clang-format --dry-run -Werror
	.venv-lint/bin/ruff check .
	.venv-lint/bin/ruff format --check .
	.venv-lint/bin/mypy

build/.docs: build/.environments pyproject.toml
	$(PYTHON) -m pip install --quiet $(call extra,docs)
	@touch $@

docs: all build/.docs
	$(PYTHON) -m sphinx -W --keep-going -q -b html docs build/docs/html
	@echo "build/docs/html/index.html"

clean:
	rm -rf build out
