# Everything on a fresh machine: `make demo` or `make test`. Needs Python 3.11-3.13 with venv, make and git.

PROGRAM ?= programs/welding.lua
# In the place of those that the program names at its top.
ROBOT ?=
IO ?=
SCENE ?=
VIEW ?= 0
# Of simulations.
DRIVE ?= second_order
# Of commands that print figures: --markdown, and others that they explain with --help.
OPTIONS ?=
ROS_DISTRO_SETUP := /opt/ros/jazzy/setup.bash

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

PACKAGES := robots_core robots_models robots_planning robots_controller
SOURCES := $(shell find $(PACKAGES) -type f -not -path '*/__pycache__/*')
BUILD_STAMP := install/.built
# Bytecode of what is installed is written even if the environment switches it off: nodes import thousands of files,
# and start faster with it.
unexport PYTHONDONTWRITEBYTECODE

ifneq ($(wildcard $(ROS_DISTRO_SETUP)),)
# ROS 2 Jazzy is installed: use its rclpy with the Python it was built for.
PYTHON ?= /usr/bin/python3
VENV_STAMP := .venv/.installed_for_ros
OTHER_VENV_STAMP := .venv/.installed
# After everything is in .venv, whatever versions of it the system has.
OPEN_VENV = $(PYTHON) -m venv --system-site-packages .venv
REQUIREMENTS := requirements.txt
BUILD_ENVIRONMENT := set +u; source $(ROS_DISTRO_SETUP); set -u; export PATH="$$PWD/.venv/bin:$$PATH";
else
PYTHON ?= python3
VENV_STAMP := .venv/.installed
OTHER_VENV_STAMP := .venv/.installed_for_ros
OPEN_VENV := true
REQUIREMENTS := requirements.txt requirements-ros.txt
BUILD_ENVIRONMENT := export PATH="$$PWD/.venv/bin:$$PATH";
endif
# Not what a shell has: the setup of a ROS 2 installation opens it to the whole subnet.
ROS_AUTOMATIC_DISCOVERY_RANGE := LOCALHOST
RUN = export ROS_DISTRO_SETUP=$(ROS_DISTRO_SETUP); source environment.bash; export ROS_AUTOMATIC_DISCOVERY_RANGE=$(ROS_AUTOMATIC_DISCOVERY_RANGE);

ENDURANCE = PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/endurance:$$PWD/test/support"

# By uv, which takes a quarter of the time; by pip where only pip is set up for the package index.
INSTALL = export -n PYTHONPATH; \
  [ -x .venv/bin/uv ] || .venv/bin/python -m pip install --quiet --disable-pip-version-check uv==0.13.9; \
  .venv/bin/uv pip install $$([ -t 2 ] || echo --quiet) --python .venv/bin/python $(1) \
  || .venv/bin/python -m pip install $$([ -t 2 ] || echo --quiet) --disable-pip-version-check $(1)

.PHONY: help
help:  ## Show this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | sort | column -t -s "$$(printf '\t')"

$(VENV_STAMP): $(REQUIREMENTS)
	@$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(None if (3, 11) <= v <= (3, 13) else f"error: Python {v[0]}.{v[1]} found, needed is 3.11 to 3.13 (make PYTHON=python3.12 ...)")'
	@echo "Installing the requirements into .venv, once: 1.2 GB on the disk, a minute or two ..."
	@# One that was made before ROS was installed, or after, is of another Python.
	@$(PYTHON) -m venv $(if $(wildcard $(OTHER_VENV_STAMP)),--clear) .venv
	@$(call INSTALL,$(addprefix -r ,$(REQUIREMENTS)))
	@$(OPEN_VENV)
	@touch $@

# Whatever is needed besides, for some commands or for all tests at once.
EXTRAS := study mujoco plant pendant

.venv/.installed_tests: requirements-test.txt $(EXTRAS:%=requirements-%.txt) $(VENV_STAMP)
	@echo "Installing what tests need (once) ..."
	@$(call INSTALL,$(addprefix -r ,$(filter requirements-%,$^)))
	@touch $@ $(EXTRAS:%=.venv/.installed_%)

$(EXTRAS:%=.venv/.installed_%): .venv/.installed_%: requirements-%.txt $(VENV_STAMP)
	@echo "Installing $< (once) ..."
	@$(call INSTALL,-r $<)
	@touch $@

.PHONY: test-requirements
test-requirements: .venv/.installed_tests  ## Install what tests need besides

.PHONY: study-requirements
study-requirements: .venv/.installed_study  ## Install what the command `study` needs besides

.PHONY: plant-requirements
plant-requirements: .venv/.installed_plant  ## Install what I/O maps with Modbus, MQTT and OPC UA need besides

$(BUILD_STAMP): $(VENV_STAMP) $(SOURCES)
	@echo "Building the workspace (10 s) ..."
	@rm -rf build/*/build/lib
	@$(BUILD_ENVIRONMENT) python -m colcon --log-level error build --event-handlers console_direct- console_cohesion- desktop_notification- summary+ --executor sequential
	@# Files whose sources are gone: colcon leaves them.
	@for package in $(PACKAGES); do \
	  find "$$PWD/install/$$package/lib" -type f -path "*/site-packages/$$package/*" -not -path '*/__pycache__/*' \
	  | { grep -vxFf "build/$$package/install.log" || true; } | xargs -r -d '\n' rm; \
	done
	@touch $@

# What is compiled already is kept as long as its source is the same.
install/.compiled: $(VENV_STAMP) $(filter robots_core/% robots_planning/%,$(SOURCES)) | $(BUILD_STAMP)
	@$(RUN) python -m robots_planning.warm_up
	@touch $@ install/.compiled_for_cells

install/.compiled_for_cells: $(VENV_STAMP) $(filter robots_core/% robots_planning/%,$(SOURCES)) | $(BUILD_STAMP)
	@$(RUN) python -m robots_planning.warm_up --cell
	@touch $@

.PHONY: build
build: $(BUILD_STAMP) install/.compiled  ## Set up .venv, build the workspace and compile its kernels

.PHONY: demo
demo: $(BUILD_STAMP) install/.compiled$(if $(filter programs/welding.lua,$(PROGRAM)$(ROBOT)$(IO)$(SCENE)),_for_cells) $(if $(filter 1,$(VIEW)),.venv/.installed_pendant)  ## Run a robot program: PROGRAM=..., ROBOT=..., SCENE=...; VIEW=1 keeps the cell, with a page to operate it
	@$(RUN) cell_options=$$([ "$(VIEW)" = 1 ] && echo --view || true); \
	  exec install/robots_controller/lib/robots_controller/cell --program "$(PROGRAM)" --robot "$(ROBOT)" --io "$(IO)" --scene "$(SCENE)" \
	  --record out --once $$cell_options

.PHONY: simulate
simulate: build  ## Simulate a robot program without ROS: PROGRAM=..., ROBOT=..., DRIVE=..., SCENE=...
	@$(RUN) folder="out/simulated_$(basename $(notdir $(PROGRAM)))$(if $(ROBOT),_$(ROBOT))_$$(date +%Y%m%d-%H%M%S)"; \
	  mkdir -p "$$folder"; exec install/robots_controller/lib/robots_controller/simulate "$(PROGRAM)" --robot "$(ROBOT)" --drive "$(DRIVE)" \
	  --io "$(IO)" --scene "$(SCENE)" --bag "$$folder/bag" --report "$$folder/report.html"

.PHONY: mujoco-example
mujoco-example: build .venv/.installed_mujoco  ## Run a robot program on a robot in MuJoCo: PROGRAM=..., ROBOT=...
	@$(RUN) exec python examples/welding_in_mujoco.py "$(PROGRAM)" --robot "$(ROBOT)"

.PHONY: lint
lint: .venv/.installed_tests  ## Lint, format and type checks
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .
	@$(BUILD_ENVIRONMENT) python -m mypy

# The operator's page is tested in the browser of the system.
BROWSERS := chromium chromium-browser google-chrome google-chrome-stable
BROWSER := $(firstword $(foreach name,$(BROWSERS),$(shell command -v $(name))))

.PHONY: browser
browser:  ## Install Chromium for the tests of the operator's page, where there is no browser (Debian, as root)
	@$(if $(BROWSER),true,apt-get update && apt-get install --yes --no-install-recommends chromium)

.PHONY: test
test: .venv/.installed_tests  ## Lint, types and all tests
	@# The type checker has one process, compilation as many as there are jobs.
	@$(MAKE) --no-print-directory --jobs=2 build lint
	@# One more at once than there are processors: nodes wait for each other most of the time.
	@$(RUN) python -m pytest -n $$(($$(nproc) + 1)) --dist worksteal test/contract test/property test/unit \
	  test/node test/bag test/cell test/endurance $(if $(BROWSER),test/page)
	@$(if $(BROWSER),true,echo "left out: test/page, which needs Chromium; make browser installs it")

.PHONY: test-under-load
test-under-load:  ## The same beside twice as many busy processes as there are cores
	@.ci/under_load $(MAKE) test

.PHONY: generated-programs
generated-programs: build  ## Programs generated from seeds: FIRST=0, COUNT=2000, WAYS=simulated,lockstep,live; names those that break a law
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test:$$PWD/test/support" python -m cell.generated.run_seeds $(or $(FIRST),0) $(or $(COUNT),2000) $$(nproc) $(or $(WAYS),simulated)

.PHONY: random-motions
random-motions: build  ## Random motions of all robots, held to their limits at 10 kHz: FIRST=0, COUNT=10000; names seeds that break one
	@$(RUN) $(ENDURANCE) python -m random_motions $(or $(FIRST),0) $(or $(COUNT),10000) $$(nproc) $(OPTIONS)

.PHONY: chaos
chaos: build  ## Kill and freeze every node of a cell at COUNT=50 random moments; says which goals of stops and outputs are met
	@$(RUN) $(ENDURANCE) python -m chaos $(or $(COUNT),50) $(OPTIONS)

.PHONY: soak
soak: build  ## A cell that works for DURATION=3600 s: lateness of its loops, memory of its processes, as a table and a page
	@$(RUN) $(ENDURANCE) python -m soak $(or $(DURATION),3600) $(OPTIONS)

.PHONY: fuzz-messages
fuzz-messages: build .venv/.installed_tests  ## 10 000 generated messages to every topic of every node, the same in every run
	@$(RUN) python -m pytest -n $$(nproc) --dist worksteal --timeout 0 --hypothesis-profile=many test/node/test_message_fuzz.py

.PHONY: fuzz
fuzz: build .venv/.installed_tests  ## Generated messages to every node, damaged files, Lua and generated programs: for DURATION=600 s
	@$(RUN) $(ENDURANCE) python -m fuzz $(or $(DURATION),600) $(OPTIONS)

.PHONY: benchmark-controller
benchmark-controller: build  ## The controller's timing side by side with a bare rclpy timer
	@$(RUN) python test/benchmark/benchmark_controller.py

.PHONY: benchmark-first-results
benchmark-first-results: build  ## Time until the first result of every block in a process of its own
	@$(RUN) python test/benchmark/benchmark_first_results.py $(OPTIONS)

.PHONY: benchmark-cell-at-rest
benchmark-cell-at-rest: build  ## What a cell takes of a core while its robot stands, side by side with bare rclpy nodes
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/support" python test/benchmark/benchmark_cell_at_rest.py $(OPTIONS)

.PHONY: benchmark-discovery
benchmark-discovery: build  ## Until a restarted process and the others find each other, side by side with the settings of ROS
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/support" python test/benchmark/benchmark_discovery.py $(OPTIONS)

.PHONY: benchmark-plant
benchmark-plant: build .venv/.installed_tests  ## Values of a plant through a program's handler and back, side by side with bare clients; COUNT=200
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/support" python test/benchmark/benchmark_plant.py --count $(or $(COUNT),200) $(OPTIONS)

.PHONY: benchmark-simulate
benchmark-simulate: build  ## How much faster than real time simulations are, and where the time goes
	@$(RUN) python test/benchmark/benchmark_simulate.py

# Without dependencies and beside the other packages: the requirements of a peer must not change ours.
.venv/benchmark/.installed: requirements-benchmark.txt $(VENV_STAMP)
	@$(call INSTALL,--upgrade --no-deps --target .venv/benchmark -r $<)
	@touch $@

.PHONY: benchmark-analytic-ik
benchmark-analytic-ik: build .venv/benchmark/.installed  ## Analytic inverse kinematics side by side with EAIK
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/benchmark"; python test/benchmark/benchmark_analytic_ik.py

.PHONY: benchmark-kinematics
benchmark-kinematics: build .venv/benchmark/.installed  ## Kinematics and dynamics of all robots side by side with peers
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/benchmark"; python test/benchmark/benchmark_kinematics.py; \
	  python test/benchmark/benchmark_kernels.py

.PHONY: benchmark-dynamics
benchmark-dynamics: build  ## Dynamics, drives and collision checks side by side with bare Pinocchio and python-fcl
	@$(RUN) python test/benchmark/benchmark_dynamics.py; python test/benchmark/benchmark_collisions.py

.PHONY: benchmark-inverse-kinematics
benchmark-inverse-kinematics: build .venv/benchmark/.installed  ## Numerical and constrained inverse kinematics side by side with peers
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/benchmark"; python test/benchmark/benchmark_inverse_kinematics.py $(OPTIONS)

.PHONY: benchmark-planning
benchmark-planning: build .venv/benchmark/.installed  ## Planners side by side with toppra, Ruckig and trapezoids
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/benchmark"; python test/benchmark/benchmark_planning.py; \
	  python test/benchmark/benchmark_welding_cycle.py

.PHONY: benchmark-collision-free
benchmark-collision-free: build .venv/benchmark/.installed  ## Joint motions around obstacles side by side with OMPL and roboplan; OPTIONS='--count 100'
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/benchmark"; python test/benchmark/benchmark_collision_free.py $(OPTIONS)

.PHONY: benchmark-programs
benchmark-programs: build  ## Delays of motion calls and inputs, Lua statements per second next to bare Lua
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/support" python test/benchmark/benchmark_programs.py

.PHONY: benchmark-pendant
benchmark-pendant: build .venv/.installed_tests  ## The operator's page in Chromium: until usable, a press until the robot moves, ten viewers, memory for DURATION=3600 s
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/page:$$PWD/test/endurance:$$PWD/test/support" \
	  python test/benchmark/benchmark_pendant.py $(or $(DURATION),3600) $(OPTIONS)

.PHONY: benchmark-report
benchmark-report: build .venv/.installed_tests  ## Size of a report's page and time to open it, side by side with viser's export
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/page:$$PWD/test/support" python test/benchmark/benchmark_report.py

# A separate folder: the package is large, and needed here only.
.venv/example_robots/.installed: requirements-example-robots.txt $(VENV_STAMP)
	@$(call INSTALL,--upgrade --no-deps --target .venv/example_robots -r $<)
	@touch $@

.PHONY: load-example-robots
load-example-robots: build .venv/example_robots/.installed  ## Load all robots of the package example-robot-data (131 MB, once)
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/.venv/example_robots"; python test/benchmark/load_example_robots.py

.venv/.installed_docs: requirements-docs.txt $(VENV_STAMP)
	@echo "Installing what the documentation needs (once) ..."
	@$(call INSTALL,-r $<)
	@touch $@

.PHONY: docs
docs: .venv/.installed_docs $(BUILD_STAMP)  ## The documentation as a site that needs no network, in out/docs
	@$(RUN) python -m sphinx --fail-on-warning --keep-going --quiet --builder html --conf-dir docs . out/docs
	@echo "The site is in out/docs/docs/index.html"

.PHONY: notebook
notebook: build .venv/.installed_tests  ## Run the notebook of examples/ without Jupyter, and store its pictures in it
	@$(RUN) python docs/run_notebook.py examples/robot_and_path.ipynb

.PHONY: picture
picture: build  ## The moving picture of the README, drawn by the page in a Chromium of this machine
	@$(RUN) python docs/live_page.py programs/welding.lua kuka_kr210_r2700 robots_controller/doc/welding.webp

.PHONY: plots
plots: build .venv/benchmark/.installed  ## A picture per planner, every axis over its limits, in out/plots
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/programs:$$PWD/.venv/benchmark"; python test/benchmark/plot_planners.py

.PHONY: plots-motion-simulator
plots-motion-simulator: build .venv/benchmark/.installed  ## What a person in the cabin of the motion simulator feels, in out/motion_simulator; OPTIONS='--run BAG'
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/programs:$$PWD/.venv/benchmark"; python -m motion_simulator.plots $(OPTIONS)

.PHONY: plots-wheel-laboratory
plots-wheel-laboratory: build .venv/benchmark/.installed  ## What the wheel laboratory measures over slip and time, in out/wheel_laboratory; OPTIONS='--run BAG'
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/programs:$$PWD/.venv/benchmark"; python -m wheel_laboratory.plots $(OPTIONS)

.PHONY: plots-debris-removal
plots-debris-removal: build .venv/benchmark/.installed  ## Attitude and momentum while a satellite grasps a target, in out/debris_removal; OPTIONS='--run BAG'
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/programs:$$PWD/.venv/benchmark"; python -m debris_removal.plots $(OPTIONS)

.PHONY: plots-rover-placement
plots-rover-placement: build .venv/benchmark/.installed  ## Forces on arm and rover while a package is unloaded, in out/rover_placement; OPTIONS='--run BAG'
	@$(RUN) export PYTHONPATH="$${PYTHONPATH:-}:$$PWD/programs:$$PWD/.venv/benchmark"; python -m rover_mission.plots $(OPTIONS)

.PHONY: screenshots-pendant
screenshots-pendant: build .venv/.installed_tests  ## Pictures of the operator's page for the documentation: every view, size and theme
	@$(RUN) PYTHONPATH="$${PYTHONPATH:-}:$$PWD/test/page:$$PWD/test/support" python test/page/take_pictures.py

.PHONY: clean
clean:  ## Remove what was built; .venv stays
	@rm -rf build install log out
