# Everything a newcomer needs: `make run`, `make test`. Python 3.11 or newer and make, nothing else.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
export OPENBLAS_NUM_THREADS ?= 1
export PIP_DISABLE_PIP_VERSION_CHECK = 1
# Every process of a run would otherwise compile all modules and rewrite all assertions for itself.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: help setup run test check format lint types imports bench study study-advice study-change study-stops study-coverage accuracy robustness study-quality study-gap survival study-second study-third damage pictures clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 16

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed, this is " + sys.version.split()[0] + ": make PYTHON=python3.12")'
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	touch $@

# Compiled before a user waits for it; what was compiled from another text is compiled anew by itself.
KERNELS := $(shell grep -rl --include='*.py' '@kernel' advisor sim) advisor/process/compiled.py
.venv/.compiled: $(STAMP) $(KERNELS)
	$(BIN)/python -m advisor.process.first_run
	touch $@

# What tests, checks and benchmarks need beyond running: installed only for them.
.venv/.developed: .venv/.compiled
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev,report,jsbsim,bench]'
	touch $@

setup: .venv/.compiled ## build .venv with the advisor in it

run: setup ## the bundled aircraft flies, the advisor advises (HEADLESS=1: as text)
	@$(BIN)/advisor demo

# Tests of links and of processes wait for the clock: a third process works meanwhile on two cores.
test: .venv/.developed ## run all tests (long studies have their own targets)
	$(BIN)/python -m pytest -n 3 --dist loadgroup

check: .venv/.developed format-check files lint types imports sizes english words site test ## format, files, lint, types, import contracts, sizes, English, documentation, tests

format: .venv/.developed ## format the code
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

.PHONY: format-check
format-check: .venv/.developed
	$(BIN)/ruff format --check .

.PHONY: files
files: .venv/.developed ## no large file, no mark of a merge, no broken YAML
	SKIP=format,lint,types,imports $(BIN)/pre-commit run --all-files

lint: .venv/.developed
	$(BIN)/ruff check .

types: .venv/.developed
	$(BIN)/mypy

imports: .venv/.developed ## the walls of the house
	$(BIN)/lint-imports

.PHONY: sizes
sizes: .venv/.developed ## all lines and files, and other counts of the house, each with a bound that only falls
	$(BIN)/python -m benchmarks.sizes

.PHONY: mutants mutants-nightly
MUTANT_SEED ?= 1
mutants: .venv/.developed ## 24 lines that decide, drawn and changed: tests must notice 22 (MUTANT_SEED=...; ten minutes)
	$(BIN)/python -m benchmarks.mutants --seed $(MUTANT_SEED)

NIGHT := $(shell date +%Y%m%d)
mutants-nightly: .venv/.developed ## mutants of three seeds, new ones every night
	$(BIN)/python -m benchmarks.mutants --seed $(NIGHT)1 $(NIGHT)2 $(NIGHT)3

.PHONY: english
english: .venv/.developed ## docstrings, messages and pages against docs/developer/style.md
	$(BIN)/python -m benchmarks.english

bench: .venv/.developed ## every ratio of speed, each against its goal (about twenty minutes)
	$(BIN)/python -m benchmarks.estimate
	$(BIN)/python -m benchmarks.campaign
	$(BIN)/python -m benchmarks.batch
	$(BIN)/python -m benchmarks.simulator
	$(BIN)/python -m benchmarks.tlog
	$(BIN)/python -m benchmarks.link --seconds 60 --rate 2000
	$(BIN)/python -m benchmarks.tui

study: .venv/.developed ## the paper's campaign, 2,000 times a noise level, with Figure 5
	$(BIN)/advisor study --campaigns 2000 --figure docs/validation/figure-5.svg
	$(BIN)/python -m benchmarks.studies paper --campaigns 2000

study-advice: .venv/.developed ## what following the advice saves
	$(BIN)/python -m benchmarks.studies advice --campaigns 100

study-stops: .venv/.developed ## how often the default rule stops too early, and what each rule needs
	$(BIN)/python -m benchmarks.studies stops --campaigns 150

study-change: .venv/.developed ## how soon a change of the aircraft is told
	$(BIN)/python -m benchmarks.studies change --campaigns 400

study-coverage: .venv/.developed ## do intervals, stops and findings hold with faulty instruments (ten seconds a campaign)
	$(BIN)/python -m benchmarks.studies coverage --campaigns 300

SEED ?= 360127
define sealed
	rm -rf build/$(1) build/$(1).key.json build/$(1).jsonl
	$(BIN)/python -m benchmarks.$(1)_generator --cases 240 --seed $(SEED) --out build/$(1)
	$(BIN)/python -m benchmarks.sealed.answer build/$(1) build/$(1).jsonl
	$(BIN)/python -m sim commit build/$(1) build/$(1).jsonl
	$(BIN)/python -m sim reveal build/$(1) build/$(1).jsonl --details
endef
study-second: .venv/.developed ## the diagnosis on 240 flights of the second generator (SEED=...; about fifteen minutes)
	$(call sealed,second)

study-third: .venv/.developed ## the diagnosis on 240 flights of the third generator (SEED=...; about fifteen minutes)
	$(call sealed,third)

.PHONY: corpus
corpus: .venv/.developed ## 160 flights whose keys are open: at most 2 % of the verdicts may flip (about ten minutes)
	$(BIN)/python -m benchmarks.corpus

.PHONY: score-gap
EACH_OF ?= 20
score-gap: .venv/.developed ## blind flights of every generator, diagnosed and scored (SEED=..., EACH_OF=20)
	$(BIN)/python -m benchmarks.gap_score --each $(EACH_OF) --seed $(SEED)

.PHONY: fed-back metamorphic
fed-back: .venv/.developed ## improved files, fed back: none or numbers after 95 % of them (SEED=..., EACH_OF=20)
	$(BIN)/python -m benchmarks.fed_back --each $(EACH_OF) --seed $(SEED)

metamorphic: .venv/.developed ## natural changes of every recorded flight: the answers must stay (hours)
	$(BIN)/python -m benchmarks.metamorphic

FLIGHTS ?= ../shared/flights
real: .venv/.developed ## records of real aircraft against what is known of them (FLIGHTS=folder)
	$(BIN)/python -m benchmarks.real $(FLIGHTS) --write docs/data/real.json

.PHONY: flight
flight: .venv/.developed ## ArduPlane flies the written script, and `advisor expect` decides (two minutes)
	$(BIN)/python -m benchmarks.scripted.expected --junit build/flight/report.xml

.PHONY: cases
cases: .venv/.developed ## the logs of ../shared/cases against tests/shared_cases.yaml (five minutes)
	$(BIN)/python -m benchmarks.shared_cases

accuracy: .venv/.developed ## the estimator against the Cramér-Rao bound, intervals against the truth
	$(BIN)/python -m benchmarks.accuracy --write docs/data/accuracy.md

robustness: .venv/.developed ## the estimator's own start on 2,000 random aircraft
	$(BIN)/python -m benchmarks.robustness

.PHONY: nightly
nightly: .venv/.developed ## every test that `make test` leaves out: study-gap, study-quality and survival (an hour)
	$(BIN)/python -m pytest -n 2 --dist loadgroup --timeout 900 -m study

study-quality: .venv/.developed ## good manoeuvres rejected, and other tests marked as studies
	$(BIN)/python -m pytest -m study --ignore tests/gap

study-gap: .venv/.developed ## whole diagnoses of flights whose cause is known (about fifteen minutes)
	$(BIN)/python -m pytest -n 2 --dist loadgroup --timeout 900 -m study tests/gap

survival: .venv/.developed ## a live campaign in which fifty processes are killed, and one in which fifty stand still (twenty minutes)
	$(BIN)/python -m pytest -m study tests/mavlink/link/test_never_lost.py

DAMAGE_CASES ?= 3400
DAMAGE_SEED ?= 0
damage: .venv/.developed ## 10,000 damaged logs and more, read and analysed (DAMAGE_CASES of each of three kinds, DAMAGE_SEED)
	DAMAGE_CASES=$(DAMAGE_CASES) DAMAGE_SEED=$(DAMAGE_SEED) $(BIN)/python -m pytest --timeout 0 tests/test_damaged_logs.py

.PHONY: endure
ENDURE_CASES ?= 5000
ENDURE_SEED ?= 0
ENDURE_MINUTES ?= inf
endure: .venv/.developed ## 5,000 flights in every unkind form, each answered (ENDURE_CASES, ENDURE_SEED, ENDURE_MINUTES; hours)
	$(BIN)/python -m benchmarks.endure --cases $(ENDURE_CASES) --seed $(ENDURE_SEED) --minutes $(ENDURE_MINUTES)

.PHONY: site words pages examples
SAMPLES := build/samples/report.html build/samples/gap.html
PAGE := .venv/.developed $(shell find advisor -name '*.py' -o -name 'page.*')
build/samples/report.html: logs/arduplane-calm.tlog logs/arduplane-calm.yaml $(PAGE)
	mkdir -p $(@D)
	$(BIN)/advisor report logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml --gap -o $@

LATE := sim/scenarios/late-command.yaml
build/samples/gap.html: $(LATE) docs/data/late-command.yaml $(PAGE)
	mkdir -p $(@D)
	$(BIN)/python -m sim record --scenario $(LATE) --out $(@D)/late-command.tlog
	$(BIN)/advisor report $(@D)/late-command.tlog --aircraft docs/data/late-command.yaml --gap -o $@

site: $(SAMPLES) ## the documentation site, built strictly into build/site
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

words: .venv/.developed ## words of the documentation written by hand, and their limit
	$(BIN)/python -m benchmarks.pages.words

pages: .venv/.developed ## the blocks of README.md that come from docs/data
	$(BIN)/python -m benchmarks.pages

examples: .venv/.developed ## run the worked examples of the documentation, and draw the figures
	$(BIN)/python -m benchmarks.pages --examples

pictures: .venv/.developed ## the screens in the README, drawn by the running program
	$(BIN)/python -m benchmarks.pages.screens logs/bundled-demo.tlog --after 3 --out docs/assets
	$(BIN)/advisor gap logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml --figure docs/assets/gap.svg

.PHONY: wheel install-check lowest release audit container coverage
wheel: .venv/.developed ## the wheel and the source archive, in dist
	$(BIN)/python -m build

VERSION ?=
release: ## turn Unreleased of CHANGELOG.md into VERSION=1.2.3, commit, tag
	.ci/release $(VERSION)

install-check: ## the wheel in empty environments, by pip, pipx and uv (ten minutes)
	.ci/install-check

lowest: ## the lowest versions that pyproject.toml allows: text, report and both screens (five minutes)
	.ci/lowest $(PYTHON)

audit: ## known weaknesses of the tested versions
	$(PYTHON) -m venv build/audit
	build/audit/bin/pip install --quiet pip-audit
	build/audit/bin/pip-audit --requirement constraints.txt --no-deps --disable-pip

container: ## the container image (docker or podman)
	docker build -f Containerfile -t inflight-advisor .

COVERED ?= tests
coverage: .venv/.developed ## how much of advisor and sim the tests run (COVERED=tests/oem for a part)
	$(BIN)/python -m pytest -n 2 --dist loadgroup --timeout 600 --cov advisor --cov sim --cov-report term --cov-report html:build/coverage $(COVERED)

clean: ## remove .venv and caches
	rm -rf .venv build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
