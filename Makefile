# Plantimeter: one word a job. `make help` lists them.
.DEFAULT_GOAL := help
.PHONY: help packages build demo test asan fuzz bench docs format tidy clean
JOBS ?= $(shell nproc)

help: ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1	/p' $(firstword $(MAKEFILE_LIST))

packages: ## install the Debian packages that are missing (packages.txt)
	@sh cmake/install_packages.sh

build: packages ## build the library and the program in build/release
	@cmake --preset release >/dev/null
	@cmake --build build/release -j $(JOBS)

test: build ## build and run every test
	@ctest --test-dir build/release --output-on-failure -j $(JOBS)

clean: ## remove what was built
	rm -rf build demo
