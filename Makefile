# A thin front for CMake. `make demo` and `make check` do all the set-up on a fresh Debian machine.
BUILD   ?= build
JOBS    ?= $(shell nproc)
SECONDS ?= 60
CMAKE   := cmake -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo
CTEST   := ctest --output-on-failure -j $(JOBS)

.PHONY: build demo check check-long coverage mpi lint sanitize fuzz bench install package deps deps-check clean

build: deps
	@$(CMAKE) -S . -B $(BUILD) -DSTARGUARD_TESTS=OFF > /dev/null
	@cmake --build $(BUILD) -j $(JOBS)

# The main jobs on a bundled sample, with a picture and a page of them.
demo: build
	@scripts/demo.sh $(BUILD)

check: deps-check lint
	@$(CMAKE) -S . -B $(BUILD) -DSTARGUARD_TESTS=ON > /dev/null
	@cmake --build $(BUILD) -j $(JOBS)
	@$(CTEST) --test-dir $(BUILD) -LE slow
	@$(MAKE) --no-print-directory sanitize

# The test suite once more, under the address and undefined-behaviour sanitizers.
sanitize: deps-check
	@$(CMAKE) -S . -B $(BUILD)-sanitize -DSTARGUARD_SANITIZE=address,undefined > /dev/null
	@cmake --build $(BUILD)-sanitize -j $(JOBS)
	@$(CTEST) --test-dir $(BUILD)-sanitize -LE slow

# What takes too long for every change: static analysis, tests labelled slow (every case of memory and
# kills, and what sanitizers make slow), a million cases for each exact decision, a clang build, the
# thread sanitizer, the lines that tests reach, the package on a clean root, runs by mpirun, and all results of six builds at four
# numbers of threads.
check-long: check
	@scripts/tidy.sh $(BUILD)
	@scripts/cppcheck.sh
	@$(CTEST) --test-dir $(BUILD) -L slow
	@STARGUARD_LONG=100 $(CTEST) --timeout 20000 --test-dir $(BUILD) -L exact
	@$(CTEST) --test-dir $(BUILD)-sanitize -L slow
	@CC=clang $(CMAKE) -S . -B $(BUILD)-clang > /dev/null
	@cmake --build $(BUILD)-clang -j $(JOBS)
	@$(CTEST) --test-dir $(BUILD)-clang -LE slow
	@CC=clang CXX=clang++ $(CMAKE) -S . -B $(BUILD)-thread -DSTARGUARD_SANITIZE=thread > /dev/null
	@cmake --build $(BUILD)-thread -j $(JOBS)
	@$(CTEST) --timeout 3000 --test-dir $(BUILD)-thread
	@$(MAKE) --no-print-directory coverage
	@scripts/package-test.sh $(BUILD)
	@$(MAKE) --no-print-directory mpi
	@$(CTEST) --test-dir $(BUILD)-mpi -R test_mpi
	@JOBS=$(JOBS) scripts/determinism.py --matrix $(BUILD)-matrix

# Which lines the tests reach. Left out are tests of what an instrumented build cannot have: its time,
# and symbols and files that are installed.
coverage: deps-check
	@scripts/install-deps.sh coverage
	@CC=gcc CXX=g++ $(CMAKE) -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS_DEBUG=-O1 -DCMAKE_CXX_FLAGS_DEBUG=-O1 \
		-DSTARGUARD_COVERAGE=ON -S . -B $(BUILD)-coverage > /dev/null
	@cmake --build $(BUILD)-coverage -j $(JOBS)
	@find $(BUILD)-coverage -name '*.gcda' -delete
	@$(CTEST) --test-dir $(BUILD)-coverage -LE slow -E '^install/|cli/test_(interrupt|limits)'
	@scripts/coverage.py $(BUILD)-coverage

# The command line for mpirun (docs/scaling.md): build-mpi/starguard.
mpi: deps
	@scripts/install-deps.sh mpi
	@$(CMAKE) -S . -B $(BUILD)-mpi -DSTARGUARD_MPI=ON > /dev/null
	@cmake --build $(BUILD)-mpi -j $(JOBS) --target starguard_cli

lint: deps-check
	@scripts/lint.sh

# Coverage-guided fuzzing of every reader and of small structured problems, SECONDS in all.
fuzz: deps-check
	@CC=clang $(CMAKE) -S . -B $(BUILD)-fuzz -DSTARGUARD_FUZZ=ON -DSTARGUARD_SANITIZE=address,undefined > /dev/null
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

deps:
	@scripts/install-deps.sh build

deps-check:
	@scripts/install-deps.sh build check

clean:
	rm -rf $(BUILD) $(BUILD)-sanitize $(BUILD)-clang $(BUILD)-thread $(BUILD)-coverage $(BUILD)-fuzz $(BUILD)-bench $(BUILD)-mpi $(BUILD)-matrix demo
