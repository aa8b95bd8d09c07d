# Plantimeter: one word a job. `make help` lists them.
.DEFAULT_GOAL := help
.PHONY: help packages build demo test reduced asan fuzz floating bench docs format tidy clean
JOBS ?= $(shell nproc)
# Goals that `make bench` measures: BENCH=all, BENCH=P1,P9, BENCH=accuracy (errors of the traits), BENCH=scenes (organs found in
# scenes drawn at random) or BENCH=growth (time and memory of the stages over the number of points); BENCH_CSV=FILE.csv appends the rows to a file and draws it over the commits.
BENCH ?= P1,P9,P10,P12
BENCH_CSV ?=
# Seconds that each fuzz target runs in `make fuzz`.
FUZZ_SECONDS ?= 10
# Where its random inputs begin: the same for every change; FUZZ_SEED=0 begins elsewhere each time.
FUZZ_SEED ?= 1

help: ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1	/p' $(firstword $(MAKEFILE_LIST)) | expand -t 12

packages: ## install the Debian packages that are missing (packages.txt)
	@sh cmake/install_packages.sh

build: packages ## build the library and the program in build/release
	@cmake --preset release >build.log 2>&1 || { cat build.log; exit 1; }; rm -f build.log
	@cmake --build build/release -j $(JOBS)

demo: build ## measure the example plants; the results are in demo/
	@build/release/plantimeter measure examples/data/*.ply -o demo --force
	@echo "Open demo/report.html in a browser. The trait tables are demo/traits.csv and demo/plants.csv; pictures are demo/*.png;"
	@echo "labelled clouds (demo/*.labelled.ply) and leaf meshes (demo/*.leaves.ply) open in CloudCompare or MeshLab."

test: build ## build and run every test
	@ctest --test-dir build/release --output-on-failure -j $(JOBS)

asan: packages ## run the tests under AddressSanitizer and UndefinedBehaviorSanitizer
	@cmake --preset asan >/dev/null
	@cmake --build build/asan -j $(JOBS)
	@ctest --test-dir build/asan --output-on-failure -j $(JOBS)

fuzz: packages ## run each fuzz target for FUZZ_SECONDS
	@cmake --preset fuzz >/dev/null
	@cmake --build build/fuzz -j $(JOBS) --target fuzzers
	@sh tests/fuzz/run.sh build/fuzz $(FUZZ_SECONDS) $(FUZZ_SEED)

floating: build ## check that digits do not depend on compiler, optimisation, FMA or threads, and that no exception is raised
	@sh tests/house/floating.sh $(CURDIR) build/release/plantimeter

bench: build ## measure speed against PCL, FLANN, CGAL and qhull, as ratios
	@sh bench/run.sh build/release/bench $(BENCH) $(BENCH_CSV)

docs: build ## build the API reference in build/docs (no warnings allowed) and refresh docs/traits.md, docs/statistics.md
	@build/release/plantimeter traits --markdown >docs/traits.md
	@build/release/plantimeter validate --statistics >docs/statistics.md
	@mkdir -p build/docs && doxygen docs/Doxyfile

format: packages ## format every source file
	@git ls-files '*.c' '*.h' '*.cpp' '*.hpp' | xargs clang-format -i

reduced: packages ## build without virtual plants and georeferencing, and check that it says so
	@sh tests/house/reduced.sh $(CURDIR)

tidy: packages ## static analysis
	@sh tests/house/tidy.sh

clean: ## remove what was built
	rm -rf build demo
