# tests.mk: what is tested by what. A new file in its folder is found by itself.
#
#   tests/unit/test_NAME.c    one cmocka group, no GPU
#   tests/gpu/test_NAME.c     one cmocka group, run on each driver of DRIVERS
#   tests/scripts/NAME.sh     exit 0: passed, 77: skipped
#   tests/full/NAME.sh        the same, with FULL=1 only
#   tests/fuzz/fuzz_NAME.c    LLVMFuzzerTestOneInput; its seeds are the files of FUZZ_SEEDS_NAME: small ones in
#                             tests/fuzz/corpus/NAME, or what tests/fuzz/seed_NAME.c writes
#   tests/cached/*            in the PATH of tests, before the tools of the same name
#   tests/support/*.c         what several tests need
#   tests/reference/*.c       what shaders do, again: in C, in double precision
#   tests/scenes/NAME.json    a scene for tests, baked to $(BUILD)/scenes
#   tests/scenes/stiff/NAME.json     a scene with NAME.sdf beside it, baked to $(MADE)/stiff for test_stiff,
#                             with its truth in double precision

# TESTS="arena frame" leaves only those.
TESTS ?=
wanted := $(foreach t,$(TESTS),%/$(t) %/test_$(t) %/fuzz_$(t) %/$(t).sh)
only = $(if $(wanted),$(filter $(wanted),$(1)),$(1))

test_programs = $(call only,$(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard $(1))))
GPU_TESTS    := $(call test_programs,tests/gpu/test_*.c)
FUZZ_TESTS   := $(call test_programs,tests/fuzz/fuzz_*.c)
# Those that look at texts and not at what is built say nothing new a second time: NESTED is set by tests/full.
TEXT_TESTS   := $(addprefix tests/scripts/,dialect.sh docs.sh docs_tables.sh facts.sh layers.sh source_gates.sh install.sh bundle.sh exports.sh abi.sh bindings.sh sizes.sh floats.sh)
TEXT_TESTS   += $(BUILD)/tests/unit/test_shader_gates
# Nor do those that take long for code that unit tests go through, or whose time goes by in a driver.
LONG_TESTS   := $(addprefix tests/scripts/,bake_blocks.sh bake_limits.sh bake_probes.sh bake_rays.sh bake_reflected_sdf.sh \
    bake_static.sh compare.sh drive.sh meso.sh scene_forms.sh sdfc.sh view.sh)
# Nor sums and simulated loads, which touch no memory but their own variables.
SUM_TESTS    := $(addprefix $(BUILD)/tests/unit/test_,brdf camera cull device_class environment governor governor_host governor_loads \
    ladder masks sequence sky vndf)
once_is_enough = $(filter-out $(if $(NESTED),$(TEXT_TESTS) $(LONG_TESTS) $(SUM_TESTS)),$(1))
UNIT_TESTS   := $(call once_is_enough,$(call test_programs,tests/unit/test_*.c))
SCRIPT_TESTS := $(call only,$(call once_is_enough,$(wildcard tests/scripts/*.sh $(if $(FULL),tests/full/*.sh))))
DRIVER_INFO  := $(BUILD)/tests/driver_info

# Every program is linked with everything, of which the linker takes what is needed.
TEST_ARCHIVES := $(BUILD)/lib/libmasu-test-support.a $(BUILD)/lib/libmasu-reference.a
TEST_ARCHIVES += $(MEASURE_ARCHIVES) $(call tool_archive,meso) $(BAKE_ARCHIVES)
TEST_LIBS     := -Wl,--as-needed -lcmocka $(MASU_LIBS) $(BAKE_LIBS)
FUZZ_MAIN     := $(BUILD)/obj/tests/fuzz/standalone_main.o

$(BUILD)/lib/libmasu-test-support.a: $(call objects,$(wildcard tests/support/*.c))
$(BUILD)/lib/libmasu-reference.a: $(call objects,$(wildcard tests/reference/*.c))

$(BUILD)/tests/%: LIBS = $(TEST_LIBS)

# Devices and what is compiled on them are kept from one session of a program to the next (support/kept.h).
KEPT_KINDS := ShaderModule Sampler DescriptorSetLayout PipelineLayout RenderPass Buffer CommandPool DescriptorPool
KEPT_KINDS += Fence Framebuffer Image ImageView QueryPool Instance Device
KEPT_FUNCTIONS := $(foreach k,$(KEPT_KINDS),Create$(k) Destroy$(k)) CreateComputePipelines CreateGraphicsPipelines
KEPT_FUNCTIONS += DestroyPipeline AllocateMemory FreeMemory GetInstanceProcAddr GetDeviceProcAddr
$(BUILD)/tests/gpu/%: LIBS = $(patsubst %,-Wl$(comma)--wrap=vk%,$(KEPT_FUNCTIONS)) $(TEST_LIBS)
# The game's physics needs neither SDL2 nor a driver.
$(BUILD)/tests/unit/test_drive: $(call objects,examples/drive/car.c examples/drive/track.c)
# What is kept would not be made again.
$(BUILD)/tests/gpu/test_reinit: LIBS = $(TEST_LIBS)

$(BUILD)/tests/unit/%: $(BUILD)/obj/tests/unit/%.o $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/gpu/%: $(BUILD)/obj/tests/gpu/%.o $(KEEP_LOADED) $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/fuzz/%: $(BUILD)/obj/tests/fuzz/%.o $(FUZZ_MAIN) $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/threads: LIBS = $(MASU_LIBS)
$(BUILD)/tests/threads: $(BUILD)/obj/tests/threads.o $(KEEP_LOADED) $(PLATFORM)
	$(link)
$(DRIVER_INFO): $(BUILD)/obj/tests/driver_info.o $(KEEP_LOADED)
	$(link)

# Scenes that tests read, by name, are baked before these tests. Programs wait for them; scripts have no file to wait
# with, so whoever runs scripts does.
TEST_SCENES := $(shell tests/scenes_of.sh)
scenes_named = $(if $(filter *,$(1)),$(SCENES),$(addprefix $(MADE)/scenes/,$(addsuffix .masu,$(1))))
scenes_of_test = $(call scenes_named,$(subst $(comma), ,$(word 2,$(subst :, ,$(1)))))
$(foreach t,$(filter unit/% gpu/%,$(TEST_SCENES)),$(eval $(BUILD)/tests/$(firstword $(subst :, ,$(t))): | $(call scenes_of_test,$(t))))
SCRIPT_SCENES := $(sort $(foreach t,$(filter $(patsubst tests/%.sh,%:%,$(filter tests/scripts/%,$(SCRIPT_TESTS))),$(TEST_SCENES)), \
    $(call scenes_of_test,$(t))))

# The folder of masu bench.
$(BUILD)/tests/gpu/test_bench: | $(MADE)/stiff/blend.masu $(MADE)/stiff/blend.truth.so

# ---- Stiff and extreme scenes, and their truths ---------------------------------------------------

STIFF := $(patsubst tests/scenes/stiff/%.json,$(MADE)/stiff/%.masu,$(wildcard tests/scenes/stiff/*.json))
$(STIFF): $(MADE)/stiff/%.masu: tests/scenes/stiff/%.json tests/scenes/stiff/%.sdf $(MADE)/bin/masu-bake.code
	@mkdir -p $(@D)
	@echo "  BAKE    $<"
	$(V)$(BAKE_ENV) $(MADE)/bin/masu-bake $< -o $@ --quiet

# $(1)/NAME.truth.c, the field of a stiff scene in double precision
define stiff_truth
$(1)/%.truth.c: tests/scenes/stiff/%.sdf $(MADE)/bin/masu-sdfc
	@mkdir -p $$(@D)
	$$(V)$(MADE)/bin/masu-sdfc $$< --c $$@ --quiet
endef
$(eval $(call stiff_truth,$(MADE)/stiff))

# Those of `masu conform --suite extreme` are also in the folder that the suite names.
EXTREME := figures figures_far figures_far7 lipschitz_2 lipschitz_10 displace_sine lipschitz_100 lipschitz_1000
EXTREME += rods ground grazing many
EXTREME := $(EXTREME:%=$(MADE)/scenes/extreme/%.masu)
$(EXTREME) $(EXTREME:.masu=.truth.so): $(MADE)/scenes/extreme/%: $(MADE)/stiff/%
	@mkdir -p $(@D)
	$(V)ln -f $< $@ 2> /dev/null || cp -p $< $@

$(BUILD)/tests/gpu/test_stiff $(BUILD)/tests/gpu/test_specular_sdf: | $(STIFF) $(STIFF:.masu=.truth.so)
$(BUILD)/tests/gpu/test_conform: | $(EXTREME) $(EXTREME:.masu=.truth.so)

# docs/stability.md: what the suite and the tests measure on each of the drivers.
.PHONY: stability
stability: scenes $(BUILD)/bin/masu $(SUITES) $(EXTREME) $(EXTREME:.masu=.truth.so) $(DRIVER_INFO) ## write docs/stability.md: extreme inputs, conditions and measured values on three drivers
	$(V)BUILD='$(BUILD)' MADE='$(MADE)' tests/stability.sh

# The thread sanitizer: minutes, most of them to compile.
.PHONY: threads threads-built
threads: $(GENERATED) $(MADE)/scenes/test_reserve.masu $(MADE)/stiff/blend.masu $(MADE)/stiff/blend.truth.so $(MADE)/textures/made ## run four renderers in four threads, and the threads of the programs, under the thread sanitizer: DRIVERS=
	+$(V)$(more) config=thread BUILD='$(BUILD)/thread' MADE='$(MADE)' threads-built
threads-built: $(BUILD)/tests/threads $(BUILD)/bin/masu $(BUILD)/bin/masu-bake
	$(V)BUILD='$(BUILD)' MADE='$(MADE)' DRIVERS='$(DRIVERS)' tests/threads.sh

# Random rungs, cameras, scenes, sizes; the tests do a twentieth of it.
.PHONY: soak
soak: scenes $(BUILD)/tests/gpu/test_soak $(DRIVER_INFO) ## render 20,000 random frames, compare memory with a plain submission loop: SOAK_FRAMES= DRIVERS=
	$(V)SOAK_FRAMES=$(or $(SOAK_FRAMES),20000) MASU_TEST_TIMEOUT=7200 $(RUN_TESTS) --gpu $(BUILD)/tests/gpu/test_soak; code=$$?; \
	    cat $(BUILD)/test-results/*/test_soak.log; exit $$code

# Some minutes: instrumented shaders are slow to compile.
.PHONY: gpu-av
gpu-av: scenes $(STIFF) $(BUILD)/tests/gpu/test_gpu_av $(DRIVER_INFO) ## render every scene under GPU-assisted validation and best practices: DRIVERS=
	$(V)GPU_AV_SCENES='$(or $(GPU_AV_SCENES),$(SCENES) $(STIFF))' MASU_TEST_TIMEOUT=7200 \
	    $(RUN_TESTS) --gpu $(BUILD)/tests/gpu/test_gpu_av; code=$$?; \
	    grep -h ' messages' $(BUILD)/test-results/*/test_gpu_av.log; exit $$code

# Whatever GPU the Vulkan loader finds: one folder to send in.
.PHONY: device-report
device-report: scenes $(BUILD)/bin/masu $(SUITES) $(EXTREME) $(EXTREME:.masu=.truth.so) $(GPU_TESTS) $(DRIVER_INFO) ## write tests, suites, ladder and times of this machine's GPU to docs/devices/NAME: DRIVERS=any NAME= MINUTES=20
	$(V)BUILD='$(BUILD)' MADE='$(MADE)' NAME='$(NAME)' MINUTES='$(or $(MINUTES),20)' \
	    TESTS='$(GPU_TESTS)' tests/device_report.sh $(if $(filter-out system,$(DRIVERS)),$(DRIVERS),any)

# ---- Fuzzing. Seeds are whole files; without any, a fuzzer starts from nothing. ------------------

# Blobs of a few kilobytes, in which most mutations hit something that is looked at, and a real one that is not large:
# every input is hashed.
FUZZ_SEEDS_scene := $(patsubst %,$(BUILD)/tests/fuzz/%.masu,scene textures lods trace skins code lighting reflections)
FUZZ_SEEDS_scene += $(firstword $(filter %/test_both.masu,$(SCENES)) $(SCENES))

$(BUILD)/tests/fuzz/seed_scene: $(BUILD)/obj/tests/fuzz/seed_scene.o $(TEST_ARCHIVES)
	$(link)
$(BUILD)/tests/fuzz/scene.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 31
$(BUILD)/tests/fuzz/textures.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 33
$(BUILD)/tests/fuzz/lods.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 65
$(BUILD)/tests/fuzz/trace.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 257
$(BUILD)/tests/fuzz/skins.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 17921
$(BUILD)/tests/fuzz/lighting.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 129
$(BUILD)/tests/fuzz/reflections.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 12579
# The code of an SDF alone: most of such a blob's words are SPIR-V's.
$(BUILD)/tests/fuzz/code.masu: $(BUILD)/tests/fuzz/seed_scene
	$(V)$< $@ 10
$(BUILD)/tests/fuzz/fuzz_scene: | $(FUZZ_SEEDS_scene)

# Every feature in a few lines, and a scene.
FUZZ_SEEDS_sdfc := tests/unit/features.sdf scenes/rods.sdf scenes/creature.sdf scenes/skyline.sdf

# Every feature that is read, in a small file.
FUZZ_SEEDS_gltf := tests/fuzz/all.gltf
# Modules, and what `masu conform` and `masu bench` read.
$(foreach n,spirv suite ladder sweep machine png panorama acc description,$(eval FUZZ_SEEDS_$(n) := $(wildcard tests/fuzz/corpus/$(n)/*)))

FUZZ_SEEDS_description += $(wildcard scenes/*.json)

FUZZ      ?= scene
FUZZ_TIME ?= 60
FUZZ_ALL  := $(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
fuzz-%: $(BUILD)/obj/tests/fuzz/fuzz_%.o $(TEST_ARCHIVES) $(FUZZ_SEEDS_$(FUZZ))
	$(V)mkdir -p $(BUILD)/corpus/$*
	$(V)$(CC) -fsanitize=fuzzer $(LINK_FLAGS) $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group $(TEST_LIBS) -o $(BUILD)/fuzz_$*
	$(V)cp $(FUZZ_SEEDS_$*) $(BUILD)/corpus/$*/
	$(V)$(BUILD)/fuzz_$* -max_total_time=$(FUZZ_TIME) -timeout=25 -print_final_stats=1 -artifact_prefix=$(BUILD)/ $(BUILD)/corpus/$*

# ---- Running -------------------------------------------------------------------------------------

# Leaks inside drivers and Assimp are theirs.
SANITIZER_ENV := LSAN_OPTIONS=suppressions=$(CURDIR)/tests/lsan.supp:print_suppressions=0
# Tests' scenes share SDFs; their modules are optimised and checked once (tests/cached).
SPIRV_CACHE   := MASU_SPIRV_CACHE='$(abspath $(MADE))/cache/spirv'
BAKE_ENV      := $(SANITIZER_ENV) $(SPIRV_CACHE) PATH="$(CURDIR)/tests/cached:$$PATH"

fuzz_seeds = SEEDS_$(notdir $(1))='$(FUZZ_SEEDS_$(patsubst fuzz_%,%,$(notdir $(1))))'
RUN_TESTS  = $(SANITIZER_ENV) $(SPIRV_CACHE) CC='$(CC)' CXX='$(CXX)' BUILD='$(BUILD)' MADE='$(MADE)' config='$(config)' \
    WERROR='$(WERROR)' DRIVERS='$(DRIVERS)' LONG='$(LONG)' $(foreach t,$(FUZZ_TESTS),$(call fuzz_seeds,$(t))) \
    tests/run.sh
# With FULL=1 the fuzzers run with the sanitizers (tests/full), on the same inputs.
RUN_UNIT   = --unit $(UNIT_TESTS) --script $(SCRIPT_TESTS) --fuzz $(if $(FULL),,$(FUZZ_TESTS))
RUN_GPU    = --gpu $(GPU_TESTS)
