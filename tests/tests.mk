# tests.mk: what is tested by what. A new file in its folder is found by itself.
#
#   tests/unit/test_NAME.c    one cmocka group, no GPU
#   tests/gpu/test_NAME.c     one cmocka group, run on each driver of DRIVERS
#   tests/unit/NAME.sh        exit 0: passed, 77: skipped
#   tests/full/NAME.sh        the same, with FULL=1 only
#   tests/fuzz/fuzz_NAME.c    LLVMFuzzerTestOneInput; its seeds are the files of FUZZ_SEEDS_NAME,
#                             which tests/fuzz/seed_NAME.c writes where no file will do
#   tests/unit/support*.c     linked to every program of the folder, as is tests/gpu/support*.c
#   tests/reference/*.c       linked to everything
#   tests/plant/*.c           simulated GPUs for the governor; linked to its test and to `masu plant`
#   tests/stiff/NAME.json     a scene with NAME.sdf beside it, baked to $(BUILD)/stiff for test_stiff,
#                             with its truth in double precision

# TESTS="arena frame" leaves only those.
TESTS ?=
wanted := $(foreach t,$(TESTS),%/$(t) %/test_$(t) %/fuzz_$(t) %/$(t).sh)
only = $(if $(wanted),$(filter $(wanted),$(1)),$(1))

test_programs = $(call only,$(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard $(1))))
UNIT_TESTS   := $(call test_programs,tests/unit/test_*.c)
GPU_TESTS    := $(call test_programs,tests/gpu/test_*.c)
FUZZ_TESTS   := $(call test_programs,tests/fuzz/fuzz_*.c)
SCRIPT_TESTS := $(call only,$(wildcard tests/unit/*.sh $(if $(FULL),tests/full/*.sh)))
DRIVER_INFO  := $(BUILD)/tests/driver_info

REFERENCE    := $(BUILD)/lib/libmasu-reference.a
TEST_LIBS    := $(REFERENCE) $(BUILD)/lib/libmasu-bench.a
TEST_LIBS    += $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
UNIT_SUPPORT := $(call objects,$(wildcard tests/unit/support*.c))
GPU_SUPPORT  := $(call objects,$(wildcard tests/gpu/support*.c)) $(KEEP_LOADED)
FUZZ_MAIN    := $(BUILD)/obj/tests/fuzz/standalone_main.o

$(REFERENCE): $(call objects,$(wildcard tests/reference/*.c))

$(BUILD)/tests/%: LIBS = -lcmocka -lvulkan -lm -ldl -lpthread

$(BUILD)/tests/unit/%: $(BUILD)/obj/tests/unit/%.o $(UNIT_SUPPORT) $(TEST_LIBS)
	$(link)
$(BUILD)/tests/gpu/%: $(BUILD)/obj/tests/gpu/%.o $(GPU_SUPPORT) $(TEST_LIBS)
	$(link)
$(BUILD)/tests/fuzz/%: $(BUILD)/obj/tests/fuzz/%.o $(FUZZ_MAIN) $(TEST_LIBS)
	$(link)
$(DRIVER_INFO): $(BUILD)/obj/tests/driver_info.o $(KEEP_LOADED)
	$(link)

# The governor and its rivals on simulated GPUs.
$(BUILD)/lib/libmasu-plant.a: $(call objects,$(wildcard tests/plant/*.c))
$(BUILD)/tests/unit/test_governor: $(BUILD)/lib/libmasu-plant.a

# Rays as the truth of ambient occlusion.
$(BUILD)/tests/gpu/test_ao: LIBS += -lembree3

# Rays as the truth of rays.
$(BUILD)/tests/gpu/test_trace: LIBS += -lembree3

# The folder of masu bench.
$(BUILD)/tests/gpu/test_bench $(BUILD)/tests/unit/test_bench_against: LIBS += -ljansson
$(BUILD)/tests/gpu/test_bench: | $(BUILD)/stiff/blend.masu $(BUILD)/stiff/blend.truth.so

# Ladders of the model sheet.
$(BUILD)/tests/gpu/test_model $(BUILD)/tests/unit/test_model: LIBS += -ljansson

# What masu-bake makes of meshes, tested apart from its command line.
BAKE_OBJECTS := $(call objects,$(wildcard tools/bake_*.c) tools/probe_light.c) $(SDFC_OBJECTS) $(CLI_OBJECTS)
BAKE_TESTS := $(addprefix $(BUILD)/tests/unit/test_,bake_detail probes trace_textures)
$(BAKE_TESTS): LIBS = -lcmocka $(BAKE_LIBS)
$(BAKE_TESTS): $(BAKE_OBJECTS)

# Light probes as the tools know them, beside what the GPU makes of them.
$(BUILD)/tests/gpu/test_probes: $(call objects,tools/probe_light.c)

$(BUILD)/tests/unit/test_environment: LIBS = -lcmocka $(BAKE_LIBS)
$(BUILD)/tests/unit/test_environment: $(BAKE_OBJECTS)

# Suites of masu conform, without a device.
$(BUILD)/tests/unit/test_conform: LIBS += -ljansson
$(BUILD)/tests/unit/test_conform: $(call objects,tools/conform_suite.c tools/conform_report.c)

# Ladders as masu bench writes them.
$(BUILD)/tests/unit/test_ladder: LIBS += -ljansson

# What masu-meso measures and fits.
$(BUILD)/tests/unit/test_meso: LIBS = -lcmocka $(MESO_LIBS)
$(BUILD)/tests/unit/test_meso: $(MESO_OBJECTS) $(BAKE_OBJECTS)
$(BUILD)/tests/gpu/test_meso: $(call objects,tools/meso_model.c)

# ---- Stiff and extreme scenes --------------------------------------------------------------------

STIFF := $(patsubst tests/stiff/%.json,$(BUILD)/stiff/%.masu,$(wildcard tests/stiff/*.json))

$(BUILD)/stiff/%.masu: tests/stiff/%.json tests/stiff/%.sdf $(BUILD)/bin/masu-bake
	@mkdir -p $(@D)
	@echo "  BAKE    $<"
	$(V)$(SANITIZER_ENV) $(BUILD)/bin/masu-bake $< -o $@ --quiet

$(BUILD)/stiff/%.truth.c: tests/stiff/%.sdf $(BUILD)/bin/masu-sdfc
	@mkdir -p $(@D)
	$(V)$(BUILD)/bin/masu-sdfc $< --c $@ --quiet

$(BUILD)/tests/gpu/test_stiff $(BUILD)/tests/gpu/test_specular_sdf: | $(STIFF) $(STIFF:.masu=.truth.so)

# ---- Fuzzing. Seeds are whole files; without any, a fuzzer starts from nothing. ------------------

# A blob of a kilobyte, in which most mutations hit something that is looked at, and a real
# one.
FUZZ_SEEDS_scene := $(patsubst %,$(BUILD)/tests/fuzz/%.masu,scene textures lods trace)
FUZZ_SEEDS_scene += $(firstword $(filter-out %/engine.masu,$(SCENES)) $(SCENES))

$(BUILD)/tests/fuzz/seed_scene: $(call objects,tests/fuzz/seed_scene.c tests/unit/support_blob.c)
	$(link)
$(BUILD)/tests/fuzz/scene.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 31
$(BUILD)/tests/fuzz/textures.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 33
$(BUILD)/tests/fuzz/lods.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 65
$(BUILD)/tests/fuzz/trace.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 257
$(BUILD)/tests/fuzz/fuzz_scene: | $(FUZZ_SEEDS_scene)

# Every feature in a few lines, and a scene.
FUZZ_SEEDS_sdfc := tests/unit/features.sdf scenes/rods.sdf
$(BUILD)/tests/fuzz/fuzz_sdfc $(BUILD)/tests/unit/test_sdfc: $(SDFC_OBJECTS)
fuzz-sdfc: $(SDFC_OBJECTS)

# What masu-bake makes of texels.
$(BUILD)/tests/unit/test_texels $(BUILD)/tests/unit/test_normal_filter: $(call objects,tools/bake_texel.c)
$(BUILD)/tests/unit/test_masks: $(call objects,tools/bake_texel.c tools/bake_mask.c)


FUZZ      ?= scene
FUZZ_TIME ?= 60
fuzz-%: $(BUILD)/obj/tests/fuzz/fuzz_%.o $(TEST_LIBS) $(FUZZ_SEEDS_$(FUZZ))
	$(V)mkdir -p $(BUILD)/corpus/$*
	$(V)$(CC) -fsanitize=fuzzer $(LINK_FLAGS) $(filter %.o %.a,$^) -lm -o $(BUILD)/fuzz_$*
	$(V)cp $(FUZZ_SEEDS_$*) $(BUILD)/corpus/$*/
	$(V)$(BUILD)/fuzz_$* -max_total_time=$(FUZZ_TIME) -artifact_prefix=$(BUILD)/ $(BUILD)/corpus/$*

# ---- Running -------------------------------------------------------------------------------------

# Leaks inside drivers and Assimp are theirs.
SANITIZER_ENV := LSAN_OPTIONS=suppressions=$(CURDIR)/tests/lsan.supp:print_suppressions=0

fuzz_seeds = SEEDS_$(notdir $(1))='$(FUZZ_SEEDS_$(patsubst fuzz_%,%,$(notdir $(1))))'
RUN_TESTS  = $(SANITIZER_ENV) CC='$(CC)' CXX='$(CXX)' BUILD='$(BUILD)' config='$(config)' \
    WERROR='$(WERROR)' DRIVERS='$(DRIVERS)' $(foreach t,$(FUZZ_TESTS),$(call fuzz_seeds,$(t))) \
    tests/run.sh
RUN_UNIT   = --unit $(UNIT_TESTS) --script $(SCRIPT_TESTS) --fuzz $(FUZZ_TESTS)
RUN_GPU    = --gpu $(GPU_TESTS)
