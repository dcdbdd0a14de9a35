# Makefile: every command a person needs; `make help` lists them.
#
# What is built from what stands in one .mk per folder; what must be installed in packages.mk. A
# bare Debian 12 with make can read this file: nothing here runs a compiler or pkg-config before the
# recipes do, and the targets that install packages (demo, check) go on in a second make.

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules

# glibc keeps what lavapipe frees, instead of mapping it anew: test_tone, with nothing cached, takes 7 s and not 9 to 10.
ifndef GLIBC_TUNABLES
empty :=
export GLIBC_TUNABLES := $(subst $(empty) ,:,$(addprefix glibc.malloc.,tcache_count=65535 mxfast=0 \
    top_pad=67108864 mmap_threshold=33554432 trim_threshold=1073741824))
endif

# ---- Settings: make NAME=value -------------------------------------------------------------------

V      ?= @
config ?= release
WERROR ?=
ifeq ($(config),release)
BUILD  ?= build
else
BUILD  ?= build/$(config)
endif
ifeq ($(config),lab)
MADE   ?= build
endif
# Headers made of shaders and tables, and baked scenes: no compiler of C changes them. MADE=build takes those of
# the main build, as they are.
MADE   ?= $(BUILD)
CC     := $(if $(filter default,$(origin CC)),gcc,$(CC))
CXX    := $(if $(filter default,$(origin CXX)),g++,$(CXX))
PREFIX ?= /usr/local
DESTDIR ?=
WORLD  ?= garden
SIZE   ?= 1280x720
DRIVERS ?= system
FULL   ?=
LONG   ?=

# ---- Flags ---------------------------------------------------------------------------------------

CONFIG_release  := -O2 -g1 -DNDEBUG
# The laboratory (lab/lab.mk), and what of the product only it has, under the define MASU_LAB.
CONFIG_lab      := $(CONFIG_release) -DMASU_LAB
CONFIG_debug    := -O0 -g3
# Undefined behaviour traps, and the address sanitizer says where: texts for each place take a tenth of the time to compile.
CONFIG_sanitize := -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined
CONFIG_sanitize += $(if $(findstring clang,$(CC)),-fsanitize-trap=undefined,-fsanitize-undefined-trap-on-error)
# tests/threads.sh
CONFIG_thread   := -O1 -g1 -fno-omit-frame-pointer -fsanitize=thread
CONFIG_coverage := -O0 -g --coverage
CONFIG_fuzz     := $(CONFIG_sanitize) -fsanitize=fuzzer-no-link
ifndef CONFIG_$(config)
$(error config=$(config) is not known: release, debug, sanitize, thread, coverage, fuzz or lab)
endif

# -ffp-contract=off and no -ffast-math: the CPU references are compared with the GPU bit for bit
# where that is possible, so a*b+c has to mean the same with every compiler.
WARNINGS   := -Wall -Wextra -Wpedantic -Wvla -Wdouble-promotion
WARNINGS   += $(if $(filter-out 0,$(WERROR)),-Werror)
INCLUDES   := -Iinclude -Isrc -Iplatform -Itools -Ishaders -Itests -I$(MADE)/gen
ALL_FLAGS   = -std=c11 $(WARNINGS) $(CONFIG_$(config)) -ffp-contract=off $(INCLUDES) $(CFLAGS)
LINK_FLAGS  = $(filter -fsanitize=% --coverage,$(CONFIG_$(config))) $(LDFLAGS)

# src/ is strict C11 and hides what is not MASU_API; the rest is POSIX. Tests keep their assert().
$(BUILD)/obj/src/%.o: FOLDER_FLAGS := -fPIC -fvisibility=hidden
$(BUILD)/obj/platform/%.o $(BUILD)/obj/tools/%.o $(BUILD)/obj/examples/%.o: FOLDER_FLAGS := -D_POSIX_C_SOURCE=200809L
$(BUILD)/obj/tests/%.o: FOLDER_FLAGS := -D_POSIX_C_SOURCE=200809L -UNDEBUG
# Tests take longer to compile than to run; slow code is in tests/support and tests/reference, compiled as all else.
ifeq ($(config),release)
$(BUILD)/obj/tests/unit/%.o $(BUILD)/obj/tests/gpu/%.o: FOLDER_FLAGS += -O1 -g1
endif
# So does, with the sanitizers, everything that no test spends its time in: a quarter of the time to compile.
ifeq ($(config),sanitize)
$(foreach f,examples src platform tests/fuzz tests/unit $(addprefix tools/,bench cli command conform masu measure meso \
    metric settings spirv view) $(addprefix tools/bake/,base build description import scene shader write), \
    $(BUILD)/obj/$(f)/%.o): FOLDER_FLAGS += -O0
$(BUILD)/obj/tests/unit/test_bake_%.o $(addprefix $(BUILD)/obj/,src/scene/reader.o src/scene/check_code.o \
    src/scene/blob_section.o tools/bake/shader/spirv.o): FOLDER_FLAGS += -O1
endif

# ---- Rules ---------------------------------------------------------------------------------------

comma := ,
objects = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))

# For programs that load Vulkan drivers: lets sanitizers tell what the drivers do from what Masu does.
KEEP_LOADED := $(if $(filter sanitize thread,$(config)),$(BUILD)/obj/tests/keep_loaded.o)

include packages.mk shaders/shaders.mk src/src.mk platform/platform.mk tools/tools.mk package/package.mk tests/tests.mk

# Classes of scenes, and the folder that each one's ladder was measured into; folders that do not exist are skipped. A
# class without a folder has the ladder of the nearest class: worlds-city shows a place in the shade, where two cascades
# instead of four cost no quality; forza has no rungs by computed costs yet.
LADDERS ?= polygons=textures sdf=city_shadows both=engine polygons-traced=mirrors both-traced=wet_city
LADDER_FOLDER ?= docs/report
ladder_scene = $(call bench_file,$(lastword $(subst =, ,$(1)))).masu
# A name is that of a scene or of a world; where both have it, the scene's: worlds/city is the other. The folder march
# is the lab's: scenes with every march, and beside them what depth is compared with.
bench_file = $(if $(filter march/%,$(1)),$(BUILD)/$(1),$(MADE)/$(if $(findstring /,$(1)),,$(if $(wildcard \
    scenes/$(1).json),scenes/,worlds/))$(1))

# Without lab/, its targets and the worlds are missing, and nothing else.
-include lab/lab.mk

# $(call keep_text,TEXT): writes TEXT to the target if its content differs; without a change the target keeps its time.
keep_text = mkdir -p $(@D); echo '$(1)' | cmp -s - $@ || echo '$(1)' > $@

# Changes when the compiler or its flags do: then everything is compiled again.
$(BUILD)/flags: force
	@$(call keep_text,$(CC) $(ALL_FLAGS))

$(BUILD)/obj/%.o: %.c $(BUILD)/flags | $(GENERATED)
	@mkdir -p $(@D)
	@echo "  CC      $<"
	$(V)$(reuse) $(CC) $(ALL_FLAGS) $(FOLDER_FLAGS) -MMD -MP -c $< -o $@

# What libraries without an interface for C need. clang's sanitizers are not gcc's. What clang calls virtually it would
# ask its C++ library about, which programs that clang links are without.
CXX_FLAGS = -std=c++17 -Wall -Wextra $(if $(filter-out 0,$(WERROR)),-Werror) $(CONFIG_$(config)) \
    $(if $(filter sanitize fuzz,$(config)),-fno-sanitize=vptr) $(CXXFLAGS)
$(BUILD)/obj/%.o: %.cpp $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  CXX     $<"
	$(V)$(if $(findstring clang,$(CC)),$(subst clang,clang++,$(CC)),$(CXX)) $(CXX_FLAGS) -MMD -MP -c $< -o $@

$(BUILD)/lib/%.a:
	@mkdir -p $(@D)
	@echo "  AR      $@"
	$(V)rm -f $@ && $(AR) rcs $@ $^

# Programs list their objects and archives as prerequisites, and what else they need in LIBS.
define link
@mkdir -p $(@D)
@echo "  LD      $@"
$(V)$(CC) $(LINK_FLAGS) $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group $(LIBS) -o $@
endef

-include $(shell find $(BUILD)/obj $(MADE)/gen -name '*.d' 2> /dev/null)

.PHONY: force
force:

# ---- Commands ------------------------------------------------------------------------------------

# As many jobs as there are processors, unless the one who called make has said how many.
more = $(MAKE) --no-print-directory $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$$(nproc))

.PHONY: all lib tools scenes shaders
all: lib tools $(EXAMPLES) ## build the library, the programs and the example (the default)
lib: $(BUILD)/lib/libmasu.a $(SHARED) ## build only build/lib/libmasu.a and libmasu.so: CLASSES="both sdf-traced"
tools: $(addprefix $(BUILD)/bin/,masu masu-bake masu-sdfc masu-meso $(if $(HAVE_VIEW),masu-view)) $(SUITES) ## build build/bin/masu, masu-bake, masu-sdfc, masu-meso; masu-view if SDL2 and Dear ImGui are installed
shaders: $(SPIRV) ## compile, validate and optimise all shaders
scenes: $(SCENES) ## bake scenes/*.json to build/scenes/*.masu

.PHONY: demo demo-picture view view-window worlds hostile
demo: deps-demo $(if $(filter forza%,$(WORLD)),deps-worlds)
demo: ## install missing packages, build, bake, render: WORLD=garden|engine|forza|city_night|... SIZE=1280x720 TIME= DEMO_ARGS=
	+$(V)$(more) demo-picture

picture := $(BUILD)/demo$(if $(filter-out garden,$(WORLD)),-$(WORLD)).png
picture_of := $(BUILD)/$(if $(filter $(WORLDS),$(WORLD)),worlds,scenes)/$(WORLD).masu
demo-picture: $(BUILD)/bin/masu $(picture_of)
	$(V)$(BUILD)/bin/masu render $(picture_of) -o $(picture) --size $(SIZE) --time $(or $(TIME),$(TIME_$(WORLD)),0) $(DEMO_ARGS)
	@echo "The image is $(abspath $(picture))"

view: deps-demo deps-view $(if $(filter forza%,$(WORLD)),deps-worlds)
view: ## install missing packages, build, open a window: a start page, or WORLD=garden|engine|forza|city_night|... VIEW_ARGS=
	+$(V)$(more) view-window

# Without a name the start page, which bakes what is chosen. A scene with a description is baked again when that or its
# field changes; worlds take too long for that.
view_baker := --bake '$(BUILD)/bin/masu-bake --texture-path $(MADE)/textures'
view_json := $(wildcard scenes/$(WORLD).json)
ifeq ($(origin WORLD),file)
view-window: $(addprefix $(BUILD)/bin/,masu-view masu-bake masu) $(MADE)/textures/made
	$(V)$(BUILD)/bin/masu-view --gallery scenes --cache $(MADE)/pictures $(view_baker) $(VIEW_ARGS)
else
view-window: $(addprefix $(BUILD)/bin/,masu-view masu-bake) $(picture_of)
	$(V)$(BUILD)/bin/masu-view $(picture_of) $(if $(TIME),--time $(TIME)) $(if $(filter $(WORLDS),$(WORLD)),, \
	    $(if $(view_json),--json $(view_json) $(view_baker))) $(VIEW_ARGS)
endif

# CI has no use for it and must not depend on it: without TORCS's data there is no forza, and that is
# no failure.
worlds: deps-build ## bake the worlds city and forza, by day and night, to build/worlds; installs torcs-data if it can
	+$(V)$(more) world-city world-city_night
	+$(V)if $(MAKE) --no-print-directory deps-worlds && [ -d "$(TORCS)" ]; then \
	    $(more) world-forza world-forza_night; \
	else \
	    echo "masu: no world forza: the package torcs-data cannot be installed here"; \
	fi

.PHONY: drive drive-long drive-built
drive: deps-demo deps-view deps-worlds ## install missing packages, build, bake, play the game on forza: DRIVE_ARGS='-t 16'
	+$(V)$(more) drive-built
	$(V)$(BUILD)/examples/drive $(DRIVE_ARGS) $(BUILD)/worlds/forza.masu $(BUILD)/worlds/forza.track
drive-long: deps-test deps-view deps-worlds ## drive a scripted lap of forza under the validation layer; images in build/drive-long
	+$(V)$(more) drive-built
	$(V)BUILD='$(BUILD)' tests/drive_long.sh $(DRIVE_ARGS)
drive-built: $(BUILD)/examples/drive $(BUILD)/worlds/forza.masu $(BUILD)/worlds/forza.track

hostile: $(BUILD)/bin/masu-bake $(BUILD)/bin/masu ## bake all models of assimp-testmodels, including broken ones: RENDER=1 DRIVERS=
	$(V)BUILD='$(BUILD)' config='$(config)' RENDER='$(RENDER)' DRIVERS='$(DRIVERS)' tests/hostile.sh

.PHONY: check check-built unit gpu stiff fuzz fuzz-all coverage
check: deps-test ## install missing packages, build, run every test: DRIVERS=system, FULL=, LONG=
	+$(V)$(more) check-built

check-built: all $(SCRIPT_SCENES) $(UNIT_TESTS) $(GPU_TESTS) $(FUZZ_TESTS) $(DRIVER_INFO)
	$(V)$(RUN_TESTS) $(RUN_UNIT) $(RUN_GPU)

# Scripts run programs, and so does test_shader_gates; other tests without a driver are linked with what they test.
unit: $(if $(TESTS),$(if $(SCRIPT_TESTS)$(filter %/test_shader_gates,$(UNIT_TESTS)),all),all)
unit: $(SCRIPT_SCENES) $(UNIT_TESTS) $(FUZZ_TESTS) ## run the tests that need no Vulkan driver: TESTS=name
	$(V)$(RUN_TESTS) $(RUN_UNIT)

gpu: | $(filter unit,$(MAKECMDGOALS)) # they use one folder for results
gpu: all $(GPU_TESTS) $(DRIVER_INFO) ## run the tests that need a Vulkan driver: DRIVERS=all TESTS=name
	$(V)$(RUN_TESTS) $(RUN_GPU)

stiff: all $(BUILD)/tests/gpu/test_stiff $(DRIVER_INFO) ## print the sphere tracer's errors on stress scenes: DRIVERS=all
	$(V)$(RUN_TESTS) --gpu $(BUILD)/tests/gpu/test_stiff; code=$$?; \
	    for f in $(BUILD)/test-results/*/test_stiff.log; do \
	        echo; echo "$$f"; grep '^|\|^  figures' "$$f"; done; exit $$code

# Shaders and the scene among the seeds are those of the normal build.
fuzzing = $(more) config=fuzz CC=clang BUILD='$(BUILD)/fuzz' MADE='$(MADE)'
fuzz fuzz-all: $(GENERATED) $(filter %/test_both.masu,$(SCENES))
fuzz: ## fuzz with clang's libFuzzer: FUZZ=name FUZZ_TIME=60
	+$(V)$(fuzzing) fuzz-$(FUZZ)
fuzz-all: ## fuzz every target of tests/fuzz: FUZZ_TIME=600 seconds each
	+$(V)for f in $(FUZZ_ALL); do $(fuzzing) fuzz-$$f FUZZ=$$f || exit 1; done

# Two hours on a CPU driver. Pages stay in build/report. docs/report keeps ladders.txt, and of each scene the ladder and
# the rows (tools/bench/keep.sh). The lab's build keeps nothing there.
# Those of a scene alone: BENCH_ARGS_NAME; there a time at which forza's car is on its lap. Rungs are chosen by the costs
# of make ladder-costs, so few runs do.
.PHONY: bench
BENCH ?= engine mirrors wet_city worlds/city forza textures city_shadows
BENCH_ARGS ?= --size 640x360 --reference 64 --frames 16 --runs 5
BENCH_ARGS_forza ?= --time 60 --positions 16
bench_truth = $(patsubst %,$(BUILD)/%.truth.so,$(filter march/%,$(BENCH)))
bench_needs = $(BUILD)/bin/masu $(foreach s,$(BENCH),$(call bench_file,$(s)).masu) $(bench_truth)
bench_scene = $(BUILD)/bin/masu bench $(call bench_file,$(1)).masu $(BENCH_ARGS) \
    $(BENCH_ARGS_$(subst /,-,$(1)))
REPORT := $(MADE)/report
bench: $(bench_needs) ## measure error against run time: build/report/index.html; ladder in docs/report: BENCH='engine worlds/city' BENCH_ARGS=
	$(V)mkdir -p $(REPORT)
	$(V)$(foreach s,$(BENCH),$(call bench_scene,$(s)) --out $(REPORT)/$(subst /,-,$(s)) &&) true
	$(V)$(BUILD)/bin/masu bench --index $(REPORT)
ifneq ($(config),lab)
	$(V)$(foreach s,$(BENCH),tools/bench/keep.sh $(REPORT)/$(subst /,-,$(s)) docs/report/$(subst /,-,$(s)) &&) true
	$(V)$(BUILD)/bin/masu bench --ladder docs/report/*/ladder.json > docs/report/ladders.txt
endif

# Whether the rungs hold on this machine, today. Nothing in docs/report is touched.
bench_again = if [ -d $(2) ]; then rm -rf $(3) && $(call bench_scene,$(1)) --rungs-of $(2) --out $(3) && \
    $(BUILD)/bin/masu bench $(2) --against $(3); else echo "masu: there is no $(2)"; fi
.PHONY: bench-again
bench-again: $(bench_needs) ## measure the rungs of docs/report again, compare error and time ratio: BENCH=
	$(V)mkdir -p $(BUILD)/again
	$(V)$(foreach s,$(BENCH),$(call bench_again,$(s),docs/report/$(subst /,-,$(s)),$(BUILD)/again/$(subst /,-,$(s))) &&) true

coverage: ## run the tests with gcov and print the lines executed of each file of src/
	+$(V)$(more) config=coverage check-built
	$(V)cd build/coverage && gcov -n -r -s $(CURDIR) $$(find obj/src -name '*.gcda') | awk -F "'" \
	    '/^File/ { f = $$2 } /^Lines/ && f { printf "%-24s %s\n", f, $$0; f = "" }'

.PHONY: sizes format format-check compdb
CLASS_OBJECTS := $(ALL_CLASSES:%=$(BUILD)/classes/%/shaders.o)
sizes: lib $(CLASS_OBJECTS) ## print the size of each object of the library, and of the library per scene class
	$(V)size -t $(BUILD)/lib/libmasu.a
	$(V)package/sizes.sh $(BUILD) $(ALL_CLASSES)
.PHONY: sizes-table
sizes-table: lib $(CLASS_OBJECTS) ## write package/sizes.csv, which tests/scripts/sizes.sh compares, and its rows in docs/embedding.md
	$(V)package/sizes.sh $(BUILD) $(ALL_CLASSES) > $(BUILD)/sizes.csv
	$(V)mv $(BUILD)/sizes.csv package/sizes.csv
	$(V)package/sizes.sh package/sizes.csv > $(BUILD)/sizes.rows
	$(V)awk -F '|' 'NR == FNR { row[$$2] = $$0; next } $$2 in row { $$0 = row[$$2] } { print }' $(BUILD)/sizes.rows \
	    docs/embedding.md > $(BUILD)/embedding.md
	$(V)mv $(BUILD)/embedding.md docs/embedding.md

FORMATTED = $(shell find include src platform tools examples tests lab -name '*.[ch]')
format: ## clang-format every C file in place
	$(V)clang-format -i $(FORMATTED)
format-check: ## fail if clang-format would change a file
	$(V)bad=$$(for f in $(FORMATTED); do clang-format $$f | cmp -s - $$f || echo "  $$f"; done); \
	    [ -z "$$bad" ] || { echo "make format would change:"; echo "$$bad"; exit 1; }

.PHONY: analyse analyse-built
analyse: deps-analyse ## install missing packages, run clang-tidy, cppcheck and gcc -fanalyzer on src/
	+$(V)$(more) analyse-built
analyse-built: $(GENERATED)
	$(V)BUILD='$(BUILD)' MADE='$(MADE)' tools/analyse/analyse.sh $(ANALYSED)

compdb: ## write compile_commands.json (with bear)
	$(V)command -v bear > /dev/null || { echo "masu: compdb needs bear" >&2; exit 1; }
	+$(V)bear -- $(MAKE) --no-print-directory -B all $(UNIT_TESTS) $(GPU_TESTS)

.PHONY: clean help
clean: ## remove the builds of all configurations; keeps build/drivers
	$(V)[ ! -d build ] || find build -mindepth 1 -maxdepth 1 ! -name drivers -exec rm -rf {} +
help: ## print this text
	@echo "make [TARGET] [config=release|debug|sanitize|thread|coverage|lab] [CC=gcc|clang] [WERROR=1] [V=]"
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/\1 \2/p' $(filter Makefile %.mk,$(MAKEFILE_LIST)) | \
	    while read -r target text; do printf '  %-14s %s\n' "$$target" "$$text"; done

# Made by chains of pattern rules, and kept. (All of them by an empty list would make make itself slow: it looks at what
# such files depend on again and again.)
.SECONDARY: $(SPIRV:.opt.spv=.spv) $(CLASS_OBJECTS:shaders.o=packed.h) $(STIFF:.masu=.truth.c) \
    $(call objects,$(foreach d,unit gpu fuzz support reference,$(wildcard tests/$(d)/*.c)) \
    tests/driver_info.c $(wildcard examples/*.c tools/generate/*.c)) $(FUZZ_MAIN) \
    $(addprefix $(MADE)/tools/make_,blue_noise split_sum smaa_area font textures)
