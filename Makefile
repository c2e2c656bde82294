# SPDX-License-Identifier: Apache-2.0
# A thin front for CMake. `make demo` and `make check` do all the set-up on a fresh Debian machine.
BUILD   ?= build
JOBS    ?= $(shell nproc)
SECONDS ?= 60
CMAKE   := cmake -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo
STRICT  := $(CMAKE) -DSTARGUARD_WERROR=ON
# One more than there are cores: some tests wait for a browser or a limit.
CTEST   := ctest --output-on-failure -j $(shell expr $(JOBS) + 1)

LONG_PARTS := analysis slow web exact memory threads mpi matrix aarch64
.PHONY: build demo tests check check-build sanitize-build check-long $(LONG_PARTS:%=check-%) \
	coverage mpi web site lint fuzz bench install package wheel release deps deps-check clean
.NOTPARALLEL: # JOBS of one target at a time

build: deps
	@$(CMAKE) -S . -B $(BUILD) -DSTARGUARD_TESTS=OFF > /dev/null
	@cmake --build $(BUILD) -j $(JOBS)

# The main jobs on a bundled sample, with a picture and a page of them.
demo: build
	@scripts/demo.sh $(BUILD)

check-build: deps-check
	@$(STRICT) -S . -B $(BUILD) -DSTARGUARD_TESTS=ON > /dev/null
	@cmake --build $(BUILD) -j $(JOBS)

tests: check-build
	@cmake --build $(BUILD) -j $(JOBS) --target other_tests

# Each test once, with sanitizers where that leaves it quick.
check: lint check-build sanitize-build
	@$(CTEST) --test-dir $(BUILD) -LE 'slow|sanitized|web'
	@$(CTEST) --test-dir $(BUILD)-sanitize -LE slow

sanitize-build: deps-check
	@$(STRICT) -S . -B $(BUILD)-sanitize -DSTARGUARD_SANITIZE=address,undefined > /dev/null
	@cmake --build $(BUILD)-sanitize -j $(JOBS)

# What takes too long for every change, hours in all; each part can be asked for alone.
check-long: check $(LONG_PARTS:%=check-%) coverage package wheel

# Static: clang-tidy and cppcheck.
check-analysis: tests
	@scripts/tidy.sh $(BUILD)
	@scripts/cppcheck.sh

# All cases of the tests that check samples; with sanitizers what check runs without, and the other way round.
check-slow: tests sanitize-build
	@cmake --build $(BUILD)-sanitize -j $(JOBS) --target other_tests
	@$(CTEST) --test-dir $(BUILD) -L 'slow|sanitized'
	@$(CTEST) --test-dir $(BUILD)-sanitize -L slow

# The browser version, opened and used.
check-web: tests
	@scripts/install-deps.sh web
	@scripts/web.sh $(BUILD) $(BUILD)-web $(JOBS)
	@$(CTEST) --test-dir $(BUILD) -L web

# A million cases for each exact decision.
check-exact: tests
	@STARGUARD_LONG=100 $(CTEST) --test-dir $(BUILD) -L exact

# Memory that is read before it is written: valgrind.
check-memory: tests
	@scripts/install-deps.sh memory
	@scripts/memory.sh $(BUILD)

# Races: the thread sanitizer, built by clang.
check-threads: deps-check
	@CC=clang $(STRICT) -S . -B $(BUILD)-thread -DSTARGUARD_SANITIZE=thread > /dev/null
	@cmake --build $(BUILD)-thread -j $(JOBS)
	@$(CTEST) --test-dir $(BUILD)-thread -LE slow

check-mpi: mpi
	@$(CTEST) --test-dir $(BUILD)-mpi -R test_mpi

# All results of six builds at four numbers of threads.
check-matrix: deps-check
	@JOBS=$(JOBS) scripts/determinism.py --matrix $(BUILD)-matrix

# Visibility, covers and pieces on another processor: gcc and clang for aarch64, qemu.
check-aarch64: deps-check
	@scripts/install-deps.sh aarch64
	@scripts/aarch64.sh $(BUILD)-aarch64 $(JOBS)

# Which lines the tests reach. Left out are tests of what an instrumented build cannot have: its time,
# and symbols and files that are installed.
coverage: deps-check
	@scripts/install-deps.sh coverage
	@CC=gcc $(STRICT) -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS_DEBUG=-O1 -DSTARGUARD_COVERAGE=ON -S . -B $(BUILD)-coverage > /dev/null
	@cmake --build $(BUILD)-coverage -j $(JOBS) --target all other_tests
	@find $(BUILD)-coverage -name '*.gcda' -delete
	@$(CTEST) --test-dir $(BUILD)-coverage -LE 'slow|web' -E '^install/|cli/test_(interrupt|limits)'
	@scripts/coverage.py $(BUILD)-coverage

# The command line for mpirun (docs/scaling.md): build-mpi/starguard.
mpi: deps
	@scripts/install-deps.sh mpi
	@$(CMAKE) -S . -B $(BUILD)-mpi -DSTARGUARD_MPI=ON > /dev/null
	@cmake --build $(BUILD)-mpi -j $(JOBS) --target starguard_cli

# The browser version, one page without a server (docs/web.md): build-web/starguard.html.
web: build
	@scripts/install-deps.sh web
	@scripts/web.sh $(BUILD) $(BUILD)-web $(JOBS)

# All pages as a site that can be searched, without a network: build-site/index.html. With the page of `make web`
# where that stands.
site: build
	@scripts/install-deps.sh site
	@/usr/bin/python3 -B scripts/site.py $(BUILD) $(BUILD)-site

lint: deps-check
	@scripts/lint.sh

# Coverage-guided fuzzing of every reader and of small structured problems, SECONDS in all.
fuzz: deps-check
	@CC=clang $(STRICT) -S . -B $(BUILD)-fuzz -DSTARGUARD_FUZZ=ON -DSTARGUARD_SANITIZE=address,undefined > /dev/null
	@cmake --build $(BUILD)-fuzz -j $(JOBS)
	@scripts/fuzz.sh $(BUILD)-fuzz $(SECONDS)

bench: build
	@scripts/install-deps.sh build bench
	@$(CMAKE) -S . -B $(BUILD)-bench -DCMAKE_BUILD_TYPE=Release -DSTARGUARD_BENCH=ON -DSTARGUARD_TESTS=OFF > /dev/null
	@cmake --build $(BUILD)-bench -j $(JOBS)
	@bench/run.sh $(BUILD)-bench

install: build
	@cmake --install $(BUILD)

# The Debian package, installed on a clean root and used there.
package: build
	@scripts/package-test.sh $(BUILD)

# The Python package with all libraries inside, in dist/; installed where there is only Python and NumPy.
wheel: deps
	@scripts/install-deps.sh wheel
	@scripts/wheel.py $(BUILD)-wheel dist
	@scripts/wheel-test.sh dist/starguard-*.whl $(BUILD)-wheel

# All that is published, in dist/ (docs/versions.md); with the web page, where that can be built.
release:
	@scripts/release.sh check
	@$(MAKE) --no-print-directory wheel package web site
	@scripts/release.sh collect $(BUILD) dist

deps:
	@scripts/install-deps.sh build

deps-check:
	@scripts/install-deps.sh build check

clean:
	rm -rf $(BUILD) $(BUILD)-sanitize $(BUILD)-thread $(BUILD)-coverage $(BUILD)-fuzz $(BUILD)-bench $(BUILD)-mpi $(BUILD)-matrix $(BUILD)-wheel $(BUILD)-web $(BUILD)-site $(BUILD)-aarch64 demo dist
