# limbcal: `make run` and `make test` do everything on a machine that has Python 3.11, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
TEST_STAMP := $(VENV)/.installed-test
BENCH_STAMP := $(VENV)/.installed-bench
MUTATE_STAMP := $(VENV)/.installed-mutate
KERNELS := $(VENV)/.kernels
TESTS_READ := $(VENV)/.tests-read
SAMPLE ?= 200
SEED ?= 0
TESTS := conftest.py $(shell find tests -name '*.py')
SOURCES := $(shell find arm daemon fitter limbcal playback protocol reproduction tracking -name '*.py')

.DEFAULT_GOAL := help
.PHONY: help run test soak check bench mutate lock clean

help: ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 10

# Python compiles what is imported, when it is, and keeps that even where it is told not to: the processes of a
# daemon would compile their libraries at every start. Much of the packages is never imported.
unexport PYTHONDONTWRITEBYTECODE
$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --constraint constraints.txt --editable '.[view]'
	@touch $@

$(TEST_STAMP): $(STAMP)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev,view,video]'
	@touch $@

# Each command compiles what it finds missing before it listens to anything; here it is done once for all of them.
$(KERNELS): $(STAMP) $(SOURCES)
	@echo "compiling kernels: some minutes the first time, seconds later on"
	@($(BIN)/limbd compile && $(BIN)/limbplay compile) & others=$$!; trap "kill $$others" INT TERM; $(BIN)/fitter compile; fitter=$$?; wait $$others && exit $$fitter
	@touch $@

# pytest rewrites what tests assert and keeps that; each of its processes would rewrite all tests, at the same time.
COLLECT := $(BIN)/python -m pytest --collect-only -qq
$(TESTS_READ): $(TEST_STAMP) $(TESTS)
	@$(COLLECT) tests/fitter tests/tracking >/dev/null &\
	  $(COLLECT) --ignore tests/fitter --ignore tests/tracking >/dev/null; wait
	@touch $@

run: $(KERNELS) ## the main job on the virtual arm: measure, calibrate, simulate, play; writes out/report.html
	@$(BIN)/python examples/main_job.py --out out

test: $(TEST_STAMP) $(KERNELS) $(TESTS_READ) ## all tests, in three processes: many wait for a device
	$(BIN)/python -m pytest -n 3 --dist worksteal --durations 40 --durations-min 5

soak: $(TEST_STAMP) ## endurance at length (two hours and a half): faults, kills, crowds, load, fuzzing; shows figures
	$(BIN)/python -m pytest --long tests/soak tests/fuzz tests/playback tests/diagnosis tests/examples/test_human_arm.py

check: $(TEST_STAMP) ## lint, types, import rules
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

$(BENCH_STAMP): $(TEST_STAMP)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[bench]'
	@touch $@

bench: $(BENCH_STAMP) ## the torque fit beside its peers (docs/benchmarks.md); acquisition; the trackers compared
	$(BIN)/python -m benchmarks.speed --out docs/benchmarks.md
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.many_joints
	$(BIN)/python -m benchmarks.acquisition --seconds 60
	$(BIN)/python -m benchmarks.touch --seconds 60
	$(BIN)/python -m benchmarks.tracking --seeds 0-2
	$(BIN)/python -m benchmarks.gaps

$(MUTATE_STAMP): $(STAMP)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[mutate]'
	@touch $@

mutate: $(MUTATE_STAMP) ## whether tests notice small faults, put into a copy of the code (SAMPLE=200, SEED=0)
	$(BIN)/python -m benchmarks.mutation --sample $(SAMPLE) --seed $(SEED)

lock: ## rewrite constraints.txt from the newest versions that fit
	rm -rf $(VENV)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[dev,view,video,cluster,bench,mutate]'
	$(BIN)/python -m pip freeze --exclude-editable > constraints.txt
	@touch $(STAMP) $(TEST_STAMP) $(BENCH_STAMP) $(MUTATE_STAMP)

clean: ## remove what the targets made
	rm -rf $(VENV) out build *.egg-info
