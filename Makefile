# make demo    set everything up in .venv and reconstruct the sample; again: go on where a run was stopped or killed
# make test    set everything up and run all tests
# make setup   only set everything up
# make config  rewrite config/ from the parameters declared in src/threedfs/params/
# make results copy the figures, tables and plots of all sequences under results/ into docs/
# make contours  train the contour detector anew: the same seed, the same bytes
# make lock    rewrite the hashed pins from envs/requirements.in and envs/slurm.in
# make setup-slurm   setup, and what runs on a Slurm cluster need (docs/cluster.md)
# make cluster-test  reconstruct the sample, in small, on a Slurm of its own on this machine, which it stops again
PYTHON ?= $(shell command -v python3.11 || command -v python3)
CORES ?= 2
BIN := .venv/bin
PINS := $(shell cksum < envs/requirements.txt | tr ' ' '-')
READY := .venv/.ready-$(PINS)

.PHONY: demo test config results contours lock setup setup-slurm cluster-test

demo: setup
	$(BIN)/snakemake --cores $(CORES)

test: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/mypy
	$(BIN)/python -m pytest

config: setup
	$(BIN)/python -m threedfs.params.document

results: setup
	$(BIN)/python -m threedfs.run_end.publish

# Without AVX-512, which rounds differently, so that the forest does not depend on whether the processor has it.
contours: export OPENCV_CPU_DISABLE = AVX512-SKX
contours: export NPY_DISABLE_CPU_FEATURES = X86_V4 AVX512_ICL AVX512_SPR
contours: setup
	$(BIN)/python benchmarks/train_contours.py

lock: setup
	$(BIN)/python -m venv .venv/lock
	.venv/lock/bin/pip install --quiet pip-tools
	for name in requirements slurm; do \
	    .venv/lock/bin/pip-compile --quiet --generate-hashes --strip-extras --allow-unsafe --no-header \
	        --no-emit-index-url --no-emit-find-links --no-emit-trusted-host \
	        --output-file envs/$$name.txt envs/$$name.in || exit 1; \
	done

setup: $(READY)

setup-slurm: setup
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r envs/slurm.txt

cluster-test: setup-slurm
	$(BIN)/python tests/cluster/run_cluster.py --install

# the environment is made anew only when the pins change
$(READY): envs/requirements.txt pyproject.toml
	@echo "Setting up .venv from hashed pins; the first time takes some minutes."
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r envs/requirements.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	rm -f .venv/.ready-*
	touch $@
