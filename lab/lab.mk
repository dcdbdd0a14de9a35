# lab.mk: the laboratory: the program masu-lab, its tests, and the targets that run it. It is a separate build,
# config=lab: with the define MASU_LAB, in build/lab. Nothing outside lab/ includes or links parts of it.
#
# In every other config the targets here start make again with config=lab. Shaders, tables and scenes are from the
# main build (MADE).

ifneq ($(config),lab)

LAB_BUILD := $(BUILD)/lab
lab_make = $(more) config=lab BUILD='$(LAB_BUILD)' MADE='$(MADE)'

.PHONY: lab lab-check
lab: $(GENERATED) ## build build/lab/bin/masu-lab, and masu and masu-bake with every march
	+$(V)$(lab_make) lab-programs
lab-check: deps-test ## install missing packages, build, run the lab's tests on the system driver: TESTS=name
	$(call install-packages,$(PACKAGES_lab))
	+$(V)$(more) tools $(sort $(foreach t,$(shell tests/scenes_of.sh lab/tests),$(call scenes_of_test,$(t))))
	+$(V)$(lab_make) lab-check-built

.PHONY: study isa-table ladders ladder-costs ladder-devices gallery
study: tools scenes ## run masu-lab study on its scenes: STUDY=march STUDY_SCENES='march/city' STUDY_ARGS=
isa-table: tools scenes ## write lab/notes/isa.csv: cost of every pipeline on the target GPUs
ladders: $(GENERATED) ## write src/quality/ladder_tables.h from docs/report/*/ladder.json: LADDERS='both=engine ...'
ladder-costs: tools $(foreach l,$(LADDERS),$(call ladder_scene,$(l))) ## choose the rungs of build/report/* by their costs on the target GPUs: MASU_ISA_DRIVERS=
ladder-devices: tools $(foreach l,$(LADDERS),$(call ladder_scene,$(l))) ## write src/quality/ladder_devices.h from the cost model: MASU_ISA_DRIVERS=
gallery: tools ## write build/gallery/index.html: all models of assimp-testmodels and tracks of TORCS: MATCH='*OBJ*' SIZE= PATHS=32
study isa-table ladders ladder-costs ladder-devices gallery:
	+$(V)$(lab_make) $@

.PHONY: mutants
mutants: all $(UNIT_TESTS) $(GPU_TESTS) $(DRIVER_INFO) ## try the mutants of lab/mutants/drawn.tsv (an hour): MUTANTS_DIR=/tmp/masu-mutants DRIVERS=system WANTED=12
	$(V)DRIVERS='$(DRIVERS)' lab/mutants/run.sh $(BUILD)/mutants.tsv

.PHONY: light
light: tools $(foreach s,alley garden night room small_lamps,$(BUILD)/scenes/$(s).masu) ## measure local lights and the live bounce beside the reference path tracer (an hour)
	+$(V)$(lab_make) $@

.PHONY: isa-drivers
isa-drivers: ## build Intel's, Adreno's, the Raspberry Pi's and Mali's compilers for MASU_ISA_DRIVERS=build/isa-drivers (twenty minutes)
	$(call install-packages,$(PACKAGES_isa))
	$(V)lab/isa/drivers.sh build/isa-drivers

.PHONY: reference-blender
reference-blender: lab $(BUILD)/bin/masu-bake ## write lab/notes/reference_blender.csv: the reference path tracer beside Blender's Cycles (half an hour)
	$(call install-packages,$(PACKAGES_blender))
	$(V)blender -b --factory-startup --python-exit-code 1 -P lab/reference/blender.py -- \
	    $(BUILD)/bin/masu-bake $(LAB_BUILD)/bin/masu-lab lab/notes/reference_blender.csv

# ---- Worlds: written by masu-lab, and baked like other scenes. Not part of `all` or of the tests. ----

$(LAB_BUILD)/bin/masu-lab: force | $(GENERATED)
	+$(V)$(lab_make) $@

# Both descriptions of a world are written together: by day and by night.
$(BUILD)/worlds/city/city.json $(BUILD)/worlds/city/city_night.json &: $(LAB_BUILD)/bin/masu-lab
	@mkdir -p $(@D)
	$(V)$< world city $(@D) --quiet
$(BUILD)/worlds/forza/forza.json $(BUILD)/worlds/forza/forza_night.json &: $(LAB_BUILD)/bin/masu-lab
	@mkdir -p $(@D)
	$(V)$< world forza $(@D) --torcs '$(TORCS)'
FORZA_RELIEFS := $(foreach r,asphalt grass gravel,$(BUILD)/worlds/forza/$(r).json)
$(FORZA_RELIEFS): $(BUILD)/worlds/forza/%.json: $(BUILD)/bin/masu-meso
	@mkdir -p $(@D)
	@echo "  MESO    $*"
	$(V)cd $(@D) && $(abspath $(BUILD)/bin/masu-meso) --make $* -o $* > /dev/null
$(BUILD)/worlds/forza.masu $(BUILD)/worlds/forza_night.masu: $(FORZA_RELIEFS)

.PHONY: $(WORLDS:%=world-%)
$(WORLDS:%=world-%): world-%: $(BUILD)/worlds/%.masu
define world_rule
$(BUILD)/worlds/$(1).masu: $(BUILD)/worlds/$(1:_night=)/$(1).json $(BUILD)/bin/masu-bake.code
	@echo "  BAKE    $$<"
	$$(V)$(BUILD)/bin/masu-bake $$< -o $$@ --stats $$(@:.masu=.stats.json)
endef
$(foreach w,$(WORLDS),$(eval $(call world_rule,$(w))))
$(BUILD)/worlds/forza.track: $(BUILD)/worlds/forza/forza.json
	$(V)cp $(@D)/forza/forza.track $@

else # ---- config=lab ------------------------------------------------------------------------------

LAB := $(BUILD)/bin/masu-lab
LAB_SOURCES := $(filter-out lab/command/main.c,$(wildcard lab/*/*.c))
LAB_ARCHIVE := $(BUILD)/lib/libmasu-lab.a
LAB_LINKED  := $(LAB_ARCHIVE) $(call tool_archive,meso) $(MEASURE_ARCHIVES) $(BAKE_ARCHIVES)

# Half of the objects do not depend on MASU_LAB.
reuse = lab/reuse.sh $(MADE)/obj/$*.o $@ '$(subst $() -DMASU_LAB,,$(CC) $(ALL_FLAGS))' ||
$(BUILD)/obj/lab/%.o: FOLDER_FLAGS := -D_POSIX_C_SOURCE=200809L -I.
# So that sums are the same with any machine flags.
$(BUILD)/obj/lab/reference/%.o: FOLDER_FLAGS := -D_POSIX_C_SOURCE=200809L -I. -ffp-contract=off
$(BUILD)/obj/lab/tests/%.o: FOLDER_FLAGS := -D_POSIX_C_SOURCE=200809L -UNDEBUG -O1 -I.

# Shaders that only the lab uses, as C (shaders/shaders.mk).
LAB_SPIRV := $(addprefix $(MADE)/gen/,$(sort $(shell grep -rhoE '\b[a-z0-9_]+\.spv\.h' --include='*.[ch]' lab)))
$(foreach d,lab/study lab/tests/gpu,$(foreach s,$(STAGES),$(eval $(call shader_rule,%_$(s),$(d)/%.$(s)))))
LAB_TESTS_SOURCES := $(wildcard lab/tests/*/*.c)
$(call objects,$(LAB_SOURCES) $(LAB_TESTS_SOURCES)): | $(LAB_SPIRV)

$(LAB_ARCHIVE): $(call objects,$(LAB_SOURCES))
$(LAB): LIBS = $(MASU_LIBS) $(BAKE_LIBS)
$(LAB): $(BUILD)/obj/lab/command/main.o $(BUILD)/obj/tests/support/simulated_gpu.o $(KEEP_LOADED) $(LAB_LINKED)
	$(link)

# masu conform looks for suites and their scenes next to itself.
LAB_SUITES := $(patsubst lab/%,$(BUILD)/%,$(wildcard lab/suites/*.json))
$(LAB_SUITES): $(BUILD)/%.json: lab/%.json
	@mkdir -p $(@D)
	$(V)cp $< $@

.PHONY: lab-programs
lab-programs: $(LAB) $(BUILD)/bin/masu $(BUILD)/bin/masu-bake $(LAB_SUITES)

# ---- Scenes with every march ---------------------------------------------------------------------

# For masu-lab study march: each .sdf scene, with its double-precision ground truth. For study baseline: engine.
MARCH_SCENES := $(patsubst scenes/%.sdf,$(BUILD)/march/%.masu,$(wildcard scenes/*.sdf))
MARCH_SUITE  := $(patsubst %,$(BUILD)/scenes/extreme/%.masu,displace_sine rods)
# Kept, although they are intermediate files of pattern rules.
.SECONDARY: $(LAB_SPIRV:.spv.h=.spv) $(LAB_SPIRV:.spv.h=.opt.spv) $(MARCH_SCENES:.masu=.truth.c) \
    $(MARCH_SUITE:.masu=.truth.c) $(call objects,$(LAB_TESTS_SOURCES))

# lab_bake: the first prerequisite, a scene, with every march
define lab_bake
@mkdir -p $(@D)
@echo "  BAKE    $< --variants"
$(V)$(BAKE_ENV) $(BUILD)/bin/masu-bake $< -o $@ --variants --quiet
endef
$(MARCH_SCENES): $(BUILD)/march/%.masu: scenes/%.json scenes/%.sdf $(BUILD)/bin/masu-bake
	$(lab_bake)
$(BUILD)/march/engine.masu: scenes/engine.json scenes/engine.glsl $(BUILD)/bin/masu-bake
	$(lab_bake)
$(MARCH_SUITE): $(BUILD)/scenes/extreme/%.masu: tests/scenes/stiff/%.json tests/scenes/stiff/%.sdf $(BUILD)/bin/masu-bake
	$(lab_bake)
$(BUILD)/march/%.truth.c: scenes/%.sdf $(MADE)/bin/masu-sdfc
	@mkdir -p $(@D)
	$(V)$(MADE)/bin/masu-sdfc $< --c $@ --quiet
$(eval $(call stiff_truth,$(BUILD)/scenes/extreme))

# ---- Targets that run it -------------------------------------------------------------------------

# masu-lab study $(STUDY) on each of its scenes, names as march/city, scenes/engine, worlds/forza, with STUDY_ARGS.
# The worlds are measured if they are baked (make worlds). march is one run on all scenes, for its summary; upscale
# generates its image.
STUDY ?= march
baked_worlds = $(patsubst $(MADE)/%.masu,%,$(wildcard $(WORLDS:%=$(MADE)/worlds/%.masu)))
SCENES_march       := $(MARCH_SCENES:$(BUILD)/%.masu=%)
SCENES_reflections := scenes/mirrors
SCENES_rays        := scenes/test_trace scenes/mirrors
SCENES_image       := scenes/engine
SCENES_temporal    := scenes/engine
SCENES_baseline    := march/engine march/city march/wet_city scenes/mirrors $(baked_worlds)
STUDY_SCENES ?= $(SCENES_$(STUDY))
study_blob   = $(if $(filter march/%,$(1)),$(BUILD),$(MADE))/$(1).masu
study_blobs  = $(foreach s,$(STUDY_SCENES),$(call study_blob,$(s)))
study_truths = $(if $(filter march,$(STUDY)),$(study_blobs:.masu=.truth.so))
.PHONY: study
study: $(LAB) $(study_blobs) $(study_truths)
ifeq ($(STUDY),march)
	$(V)$(LAB) study march $(study_blobs) $(STUDY_ARGS)
else ifeq ($(STUDY),upscale)
	$(V)$(LAB) study upscale $(STUDY_ARGS)
else
	$(V)mkdir -p $(BUILD)/study
	$(V)for s in $(study_blobs); do \
	    set -- ; [ $(STUDY) != baseline ] || { \
	        time=1; [ $${s##*/} != forza.masu ] || time=146.5; \
	        to=$(BUILD)/study/baseline-$$(basename $$s .masu); \
	        set -- --time $$time --truth $$to.truth.png --csv $$to.csv; }; \
	    $(LAB) study $(STUDY) $$s "$$@" $(STUDY_ARGS) || exit 1; \
	done
endif

# Rows of GPUs whose driver is not in MASU_ISA_DRIVERS do not change.
isa_with = $(if $(wildcard $(MASU_ISA_DRIVERS)/$(1).so),$(comma)$(2))
ISA_GPUS := vangogh,raven$(if $(MASU_ISA_DRIVERS),$(call isa_with,libvulkan_intel,bdw$(comma)skl$(comma)kbl$(comma)tgl)$(call isa_with,libvulkan_freedreno,a630$(comma)a660)$(call isa_with,libvulkan_panfrost,g52$(comma)g610))
.PHONY: isa-table
isa-table: $(LAB) $(SCENES)
	$(V)BUILD=$(BUILD) MADE=$(MADE) lab/isa/table.sh $(ISA_GPUS) > $(BUILD)/isa.csv
	$(V)awk -F, -v made=,$(ISA_GPUS), 'NR > 1 && !index(made, "," $$2 ",")' lab/notes/isa.csv >> $(BUILD)/isa.csv
	$(V)mv $(BUILD)/isa.csv lab/notes/isa.csv

.PHONY: ladders ladder-costs ladder-devices
ladders: $(LAB)
	$(V)files=; for l in $(LADDERS); do \
	    f=$(LADDER_FOLDER)/$${l#*=}/ladder.json; \
	    if [ -f "$$f" ]; then files="$$files $${l%%=*}=$$f"; else echo "masu: there is no $$f"; fi; \
	done; \
	[ "$$files" ] || { echo "masu: no ladder is measured; see make bench" >&2; exit 1; }; \
	$(LAB) ladder $$files > $(BUILD)/ladder_tables.h && \
	{ cmp -s $(BUILD)/ladder_tables.h src/quality/ladder_tables.h || cp $(BUILD)/ladder_tables.h src/quality/ladder_tables.h; }

# From the results of make bench in build/report; merging a folder into itself selects its rungs again.
ladder_folder = $(MADE)/report/$(lastword $(subst =, ,$(1)))
ladder_costs = $(LAB) ladder --costs $(call ladder_scene,$(1))=$(call ladder_folder,$(1))$(if $(filter \
    %=forza,$(1)),=146.5) && $(MADE)/bin/masu bench --merge $(call ladder_folder,$(1)) --out $(call ladder_folder,$(1)) && \
    tools/bench/keep.sh $(call ladder_folder,$(1)) docs/report/$(lastword $(subst =, ,$(1)))
ladder-costs: $(LAB)
	$(V)$(foreach l,$(LADDERS),$(call ladder_costs,$(l)) &&) true
	$(V)$(MADE)/bin/masu bench --ladder docs/report/*/ladder.json > docs/report/ladders.txt

# forza at a time when a car is close, as in make bench.
ladder_device = $(firstword $(subst =, ,$(1)))=$(call ladder_scene,$(1))=$(LADDER_FOLDER)/$(lastword $(subst =, \
    ,$(1)))/ladder.json$(if $(filter %=forza,$(1)),=146.5)
ladder-devices: $(LAB)
	$(V)$(LAB) ladder --devices $(foreach l,$(LADDERS),$(call ladder_device,$(l))) > $(BUILD)/ladder_devices.h
	$(V)cp $(BUILD)/ladder_devices.h src/quality/ladder_devices.h

# Comparisons with the reference: visibility, indirect light, small lamps, images of a still camera.
LIGHT = $(MADE)/light
.PHONY: light
light: $(LAB)
	$(V)mkdir -p $(LIGHT)
	$(V)for s in night alley garden; do $(LAB) study light $(MADE)/scenes/$$s.masu --sdf scenes/$$s.sdf || exit 1; done
	$(V)$(LAB) study bounce $(MADE)/scenes/room.masu --sdf scenes/room.sdf
	$(V)$(LAB) study bounce $(MADE)/scenes/room.masu --sdf scenes/room.sdf --night --lamp lamp
	$(V)$(LAB) study bounce $(MADE)/scenes/room.masu --sdf scenes/room.sdf --night --lamp lamp \
	    --camera 6.4,1.5,-1.6,8.8,1,1.2
	$(V)$(LAB) reference $(MADE)/scenes/small_lamps.masu --physics --size 320x240 --paths 128 -o $(LIGHT)/small_lamps.pfm
	$(V)$(LAB) study rest $(MADE)/scenes/small_lamps.masu --reference $(LIGHT)/small_lamps.pfm
	$(V)for s in night alley 'room --window 1.6,0.9,2,4,2.4,2.1'; do \
	    n=$${s%% *}; options=$${s#$$n}; \
	    $(LAB) reference $(MADE)/scenes/$$n.masu --sdf scenes/$$n.sdf --physics --sun-radius 0.27 --size 320x180 \
	        --paths 1024 $$options -o $(LIGHT)/$$n.png && \
	    $(MADE)/bin/masu render $(MADE)/scenes/$$n.masu --size 320x180 -o $(LIGHT)/$$n.still.png && \
	    $(MADE)/bin/masu compare $(LIGHT)/$$n.png $(LIGHT)/$$n.still.png || exit 1; \
	done

.PHONY: gallery
gallery: $(if $(PATHS),$(LAB))
	$(V)BUILD='$(MADE)' SIZE='$(if $(filter command line,$(origin SIZE)),$(SIZE),480x270)' MATCH='$(or $(MATCH),*)' \
	    PATHS='$(or $(PATHS),0)' lab/gallery/gallery.sh $(MADE)/gallery $(or $(MODELS),/usr/share/assimp/models) $(TORCS)/tracks

# ---- Tests: lab/tests/{unit,gpu,fuzz,scripts}, as in tests/tests.mk ------------------------------

lab_programs = $(call only,$(patsubst lab/tests/%.c,$(BUILD)/tests/lab/%,$(wildcard $(1))))
LAB_UNIT    := $(call lab_programs,lab/tests/unit/test_*.c)
LAB_GPU     := $(call lab_programs,lab/tests/gpu/test_*.c)
LAB_FUZZ    := $(call lab_programs,lab/tests/fuzz/fuzz_*.c)
LAB_SCRIPTS := $(call only,$(wildcard lab/tests/scripts/*.sh))
FUZZ_SEEDS_trace := $(wildcard lab/tests/fuzz/corpus/trace/*)
FUZZ_SEEDS_tally := $(wildcard tests/fuzz/corpus/spirv/*)

$(BUILD)/tests/lab/unit/%: $(BUILD)/obj/lab/tests/unit/%.o $(LAB_ARCHIVE) $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/lab/gpu/%: $(BUILD)/obj/lab/tests/gpu/%.o $(KEEP_LOADED) $(LAB_ARCHIVE) $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/lab/fuzz/%: $(BUILD)/obj/lab/tests/fuzz/%.o $(FUZZ_MAIN) $(LAB_ARCHIVE) $(TEST_ARCHIVES)
	$(link)

.PHONY: lab-check-built
lab-check-built: override DRIVERS := system
lab-check-built: lab-programs $(LAB_UNIT) $(LAB_GPU) $(LAB_FUZZ) $(DRIVER_INFO) $(MARCH_SUITE) $(MARCH_SUITE:.masu=.truth.so)
	$(V)$(foreach t,$(LAB_FUZZ),$(call fuzz_seeds,$(t))) $(RUN_TESTS) --unit $(LAB_UNIT) --script $(LAB_SCRIPTS) \
	    --fuzz $(LAB_FUZZ) --gpu $(LAB_GPU)

endif
