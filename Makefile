# The targets a developer needs; `make help` lists them.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Modules that a macro declares, which cargo fmt does not see.
CELLS := $(wildcard crates/fedic-mesh/src/cells/*.rs)
CARGO_TEST := --workspace --exclude fedic-py --exclude fedic-benches

.DEFAULT_GOAL := help
.PHONY: help setup build build-dev demo test test-rust test-python check generate format doc bench findings clean

help: ## List the targets.
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

$(VENV)/.ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip
	MATURIN_PEP517_ARGS='--profile dev' \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

setup: $(VENV)/.ready ## Make the virtual environment and install fedic in it with all its tools.

build: setup ## Compile the extension module into the environment, for measurements.
	VIRTUAL_ENV=$(abspath $(VENV)) $(BIN)/maturin develop --release --quiet

# Optimised, with checks of overflow, and shares its dependencies with the tests of the crates.
build-dev: setup ## Compile the extension module into the environment, for tests.
	VIRTUAL_ENV=$(abspath $(VENV)) $(BIN)/maturin develop --profile dev --quiet

demo: build ## Run the main job: the lens-distortion experiment, with its table and picture in fedic-demo/.
	$(BIN)/fedic demo

test: test-rust test-python ## Run every test.

# Examples are compiled by clippy.
test-rust:
	cargo test --quiet $(CARGO_TEST) --lib --bins --tests
	cargo test --quiet $(CARGO_TEST) --doc

# One worker per processor: threads of OpenBLAS would only wait for one another.
test-python: build-dev
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest --numprocesses auto --dist worksteal

check: build-dev ## Check format, lints, types, stubs and documentation; warnings are errors.
	cargo fmt --all --check
	rustfmt --check --edition 2024 $(CELLS)
	cargo clippy --quiet --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS='-D warnings' cargo doc --quiet --workspace --no-deps
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest fedic._core
	$(BIN)/python tools/generate.py --check
	$(BIN)/python tools/lens_stubs.py --check

generate: build-dev ## Write the files made from the declarations of options and lenses: types, stubs, docs/options.md.
	$(BIN)/python tools/generate.py
	$(BIN)/python tools/lens_stubs.py

format: setup ## Format the sources.
	cargo fmt --all
	rustfmt --edition 2024 $(CELLS)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

doc: ## Build the documentation of the Rust crates.
	RUSTDOCFLAGS='-D warnings' cargo doc --workspace --no-deps

bench: build ## Time the kernels, whole measurements of 1 to 150 megapixels and a campaign; PEER_PYTHON=... adds the peers.
	cargo bench --package fedic-benches
	$(BIN)/python benches/python/compare.py $(if $(PEER_PYTHON),--peer-python $(PEER_PYTHON))
	$(BIN)/python benches/python/campaign.py $(if $(PEER_PYTHON),--peer-python $(PEER_PYTHON))

findings: ## Check the findings about other packages; needs network access and some minutes.
	@for script in findings/*.sh; do echo "$$script"; "$$script" || exit 1; done

clean: ## Remove everything built.
	rm -rf target $(VENV) fedic-demo
