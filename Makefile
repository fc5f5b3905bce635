VENV ?= .venv
PYTHON ?= python3
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
LOG := $(VENV)/install.log
# tests that wait for real ports leave cores free; libraries' own threads would take them from others
WORKERS ?= $(shell echo $$((2 * $$(getconf _NPROCESSORS_ONLN))))
PYTEST := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n $(WORKERS) --dist worksteal
KERNEL := setup.py $(wildcard gonio/kernel/* nnbrdf/kernel/* planner/kernel/*)

.PHONY: help setup demo test test-slow fuzz bench bench-evaluate bench-rehearsal calibration designs adaptive few-shots left-out \
	bad-capture sampling mitsuba twin chain color coverage arms expected imperfections scenes texels docs format clean

help:            ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

setup: $(STAMP)  ## a virtual environment with everything in it

$(STAMP): pyproject.toml constraints.txt $(KERNEL)
	@echo "installing gonio and its tools into $(VENV); this takes a minute or two"
	@$(PYTHON) -m venv $(VENV)
	@rm -f $(LOG)
	@$(BIN)/pip install -q --log $(LOG) --disable-pip-version-check -c constraints.txt \
		-e '.[nn,dev,docs]' >$(LOG).screen 2>&1 || { cat $(LOG).screen; exit 1; }
	@sed -n 's/.*\(gonio was installed without\)/\1/p' $(LOG)
	@touch $@

demo: setup      ## plan, capture on the simulated rig, reconstruct; then open demo/session/report.html
	@rm -rf demo && mkdir demo
	cd demo && ../$(BIN)/gonio plan --density sixth
	cd demo && ../$(BIN)/gonio capture --sim --material wood-veneer
	cd demo && ../$(BIN)/gonio reconstruct session/

test: setup      ## format, lint, types, layers, then the tests
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(PYTEST)

test-slow: setup ## the tests that make test leaves out: half a minute and more each
	$(PYTEST) -m slow

fuzz: setup      ## mutated files at every importer, coverage-guided: RUNS=20000 each
	@$(BIN)/pip install -q --disable-pip-version-check -c constraints.txt -e '.[fuzz]'
	$(BIN)/python -m tests.fuzz.fuzz_importers $(or $(RUNS),20000)

bench: setup     ## benchmarks: ratios to named alternatives, each in one run
	$(BIN)/python -m pytest tests/benchmarks -s --override-ini='python_files=bench_*.py'

bench-rehearsal: setup  ## the whole 6561 shots on the twin without pictures, twice (4 minutes)
	$(BIN)/python -m pytest tests/benchmarks/bench_rehearsal.py -s --override-ini='python_files=bench_*.py'

bench-evaluate: setup  ## evaluation time: NumPy, kernel, compiled GGX, on one core
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest tests/benchmarks/bench_evaluate.py -s --override-ini='python_files=bench_*.py'

calibration: setup  ## does the band hold nine of ten, over 1000 materials (6 minutes)
	$(BIN)/python tests/benchmarks/study_calibration.py

left-out: setup  ## what leaving out saves and costs, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_left_out.py $(MATERIALS)

adaptive: setup ## error against shots, in rounds and fixed, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_adaptive.py $(MATERIALS)

few-shots: setup ## 64 and 196 shots against all, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_few_shots.py $(MATERIALS)

color: setup     ## how well matrices fit measured cameras under several lamps (20 seconds)
	$(BIN)/python tests/benchmarks/study_color.py

bad-capture: setup  ## what noise, faults and gaps cost, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_bad_capture.py $(MATERIALS)

sampling: setup  ## variance of importance sampling against sampling by the cosine: MODELS=folders
	$(BIN)/python tests/benchmarks/study_sampling.py $(MODELS)

mitsuba: setup   ## Mitsuba's chi-square test of the exported plugin (needs LLVM 17 or newer)
	$(BIN)/python -m tests.benchmarks.study_mitsuba

twin: setup      ## the noisy twin against noise-free values, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_twin.py $(MATERIALS)

imperfections: setup  ## what imperfections of camera and lamps do to samples (15 minutes)
	$(BIN)/python tests/benchmarks/study_imperfections.py

designs: setup   ## criteria of choice against chance, on a folder of measured tables: MATERIALS=folder
	$(BIN)/python tests/benchmarks/study_designs.py $(MATERIALS)

TWIN ?= ideal
coverage: setup  ## do 90 % intervals of samples hold nine of ten, over 1000 sessions that err (10 minutes; TWIN=calibrated: 20)
	$(BIN)/python -m tests.benchmarks.study_coverage --twin $(TWIN)

arms: setup      ## what arms that bend do to samples, and which stated angle holds it (10 seconds)
	$(BIN)/python -m tests.benchmarks.study_arms

PX ?= 800
chain: setup     ## every command on less than ideal twins, recovered beside injected: PX=2000 for a large sensor
	$(BIN)/python -m tests.benchmarks.study_chain --px $(PX)

expected: setup  ## does the expected error rank designs as the true one: MATERIALS="one.npz two.npz"
	$(BIN)/python tests/benchmarks/study_expected.py $(MATERIALS) -o expected.png

scenes: setup    ## error in three scenes against rig time, by plan, through the twin (10 minutes)
	$(BIN)/python tests/benchmarks/study_scenes.py

texels: setup    ## time and memory of gonio reduce --btf by the number of brackets
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/study_btf.py

docs: setup      ## the documentation site, in docs/_build
	$(BIN)/sphinx-build -W --keep-going -q docs docs/_build

format: setup    ## write the format that test checks
	$(BIN)/ruff format . && $(BIN)/ruff check --fix .

clean:
	rm -rf $(VENV) build dist *.egg-info docs/_build demo gonio/*.so nnbrdf/*.so planner/*.so
