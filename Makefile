# SPDX-License-Identifier: MIT
# The entry point from a clone. Each target sets up the environment it needs and calls the program `raycaster` with
# make's variables unchanged: `make sim ENGINE=span SCENE=boxes` runs `raycaster sim ENGINE=span SCENE=boxes`.

ifeq ($(wildcard raycaster/cli/commands.py),)
$(error error: make must run in the folder of $(MAKEFILE_LIST); use make -C with that folder)
endif
PYTHON3 ?= python3
VENV := .venv
PYTHON := $(VENV)/bin/python
COMMANDS := sim scenes play game send walk web wave trace verilog fit area quartus bitstream registers report docs
CHECKS := soak prove mutate gate verify-all
# The program gets command-line variables exactly as typed: `value` and `unexport` keep make from expanding them, quotes
# keep the shell from expanding them, and one shell per recipe preserves line breaks inside them.
GIVEN := $(foreach name,$(.VARIABLES),$(if $(filter command,$(firstword $(origin $(name)))),$(name)))
$(foreach name,$(GIVEN),$(eval unexport $(name)))
quoted = '$(subst ','\'',$1)'
ARGUMENTS = $(foreach name,$(filter-out PYTHON3 PYTHON VENV,$(GIVEN)),$(call quoted,$(name)=$(value $(name))))
.ONESHELL:
.SHELLFLAGS := -ec

# Extras of pyproject.toml that a target needs in addition to the program itself.
play game web: EXTRAS := play
send walk: EXTRAS := board
fit area: EXTRAS := fpga
bitstream: EXTRAS := fpga,play
report: EXTRAS := fpga,report
docs: EXTRAS := docs,play
prove: EXTRAS := formal
sim: EXTRAS := $(if $(filter-out 0,$(value GATES)),formal)
mutate: EXTRAS := formal,test
lint test gate verify-all: EXTRAS := formal,fpga,report,play,docs,test
TOOLS := -m raycaster.sim.ensure_tools icarus chromium tcl

.PHONY: help $(COMMANDS) $(CHECKS) test lint clean
.NOTPARALLEL:
.DELETE_ON_ERROR:

help:
	@$(PYTHON3) raycaster/cli/commands.py

$(COMMANDS) $(CHECKS): $(VENV)/base
	@$(call install,$(EXTRAS))
	@RAYCASTER_FROM_MAKE=1 $(PYTHON) -m raycaster.cli $(if $(filter $@,$(CHECKS)),verify )$(patsubst verify-%,%,$@) $(ARGUMENTS)

lint test: $(VENV)/base
	@$(call install,$(EXTRAS))
	@$(if $(filter lint,$@),$(PYTHON) -m ruff check)
	@$(if $(filter lint,$@),$(PYTHON) -m ruff format --check)
	@$(if $(filter lint,$@),$(PYTHON) -m pyright)
	@$(if $(filter test,$@),$(PYTHON) $(TOOLS))
	@$(if $(filter test,$@),$(PYTHON) -m pytest -q -n 2 --dist worksteal -m 'not slow' --durations=10 verif/tests)

# Unknown targets.
.DEFAULT:
	@$(PYTHON3) raycaster/cli/commands.py $@

clean:
	rm -rf build .pytest_cache .ruff_cache
	find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +

# Install with uv if it is available. A stamp file per set of extras avoids asking the package index again. Modules are
# compiled when they are first imported, unless Python is told not to keep what it compiles. Meanwhile, the system's
# package manager gets the tools that tests need.
NO_COMPILE = $(if $(PYTHONDONTWRITEBYTECODE),,--no-compile)
PIP = $(or $(addsuffix  pip install --python $(PYTHON),$(shell command -v uv)),$(PYTHON) -m pip install --use-pep517 $(NO_COMPILE))
ADD = $(PIP) -q -c constraints.txt -e
install = $(if $1,if [ ! -e $(VENV)/$1 ]; then echo "installing $1 (usually a minute)"; $(ADD) '.[$1]'; touch $(VENV)/$1; fi)
$(VENV)/base: pyproject.toml constraints.txt
	@$(PYTHON3) -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { echo \
	    "error: $(PYTHON3) is not Python 3.11 or newer with its venv module (Debian: apt-get install python3-venv)" >&2; exit 2; }
	@$(PYTHON3) raycaster/places.py
	@echo "making a Python environment in $(VENV)/ (usually a minute)"
	@$(if $(filter test,$(MAKECMDGOALS)),$(PYTHON3) $(TOOLS) &)
	@$(PYTHON3) -m venv --clear $(VENV) && $(ADD) '.$(addsuffix ],$(addprefix [,$(EXTRAS)))'
	@touch $@ $(addprefix $(VENV)/,$(EXTRAS)) && wait
