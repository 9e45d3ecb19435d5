# make        build everything: the core, and in each Python environment the package; .venv/bin/stormfield works
# make demo   render the storm merge to PNG frames and a video
# make test   all tests and checks, under every Blender that is found
# make bench  benchmarks; they print ratios
# make lint   formatting, ruff, mypy
# make docs   the documentation, in build/docs/html; warnings are errors
SHELL := /bin/bash
.DELETE_ON_ERROR:
JOBS ?= $(shell nproc)
PYTHON := .venv/bin/python
# Clones in different places share what ccache holds.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := 1
# The packages of an extra of pyproject.toml.
extra = $$(python3 -c "import re; \
  print(*re.findall(r'\"([^\"]+)\"', re.search(r'^$(1) = \[(.*)\]', open('pyproject.toml').read(), re.M).group(1)))")
ENVIRONMENTS = $(shell scripts/environments.sh list)

core_sources := $(shell find native cmake CMakeLists.txt CMakePresets.json -type f)
addon_sources := $(shell find addon -type f -not -path '*/__pycache__/*')

.PHONY: all demo test test-native test-python bench lint docs clean
all: build/.installed

build/.packages: scripts/debian_packages.sh
	@mkdir -p build
	scripts/debian_packages.sh
	@touch $@

build/.environments: build/.packages scripts/environments.sh pyproject.toml
	scripts/environments.sh create
	@touch $@

build/.core: build/.packages $(core_sources)
	cmake --preset core
	cmake --build --preset core -j $(JOBS)
	@touch $@

# The core is compiled once; only the bindings are compiled for each Python.
build/.installed: build/.core build/.environments $(addon_sources) pyproject.toml README.md
	@set -e; for environment in $(ENVIRONMENTS); do \
	  echo "installing stormfield into $$environment"; \
	  $$environment/bin/python -m pip install --quiet --no-deps --no-build-isolation --force-reinstall \
	    -C cmake.define.STORMFIELD_CORE_DIR=$(CURDIR)/build/core . ; \
	done
	@touch $@

demo: all
	$(PYTHON) blend_examples/demo.py

test: lint test-native test-python docs

test-native: build/.packages
	cmake --preset asan
	cmake --build --preset asan -j $(JOBS)
	ctest --preset asan -j $(JOBS)

test-python: all
	@set -e; for environment in $(ENVIRONMENTS); do \
	  echo "tests under $$environment"; \
	  $$environment/bin/python -m pytest tests; \
	done

build/.bench: build/.environments pyproject.toml
	$(PYTHON) -m pip install --quiet $(call extra,bench)
	@touch $@

bench: all build/.bench
	cmake --preset bench
	cmake --build --preset bench -j $(JOBS) --target bench_native
	build/bench/tests/native/bench_native
	$(PYTHON) -m pytest -p no:cacheprovider --rootdir tests/benchmarks -s tests/benchmarks

build/.lint: pyproject.toml
	@mkdir -p build
	python3 -m venv .venv-lint
	.venv-lint/bin/python -m pip install --quiet $(call extra,lint)
	@touch $@

lint: build/.packages build/.lint
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
