# tools.mk: the programs, and what they and the tests share. A folder of tools/ is one archive; a
# program is its main file and the archives that hold what it calls, of which the linker takes what
# is needed.

# ---- Archives: one per folder of tools/ ----------------------------------------------------------

tool_archive = $(BUILD)/lib/libmasu-$(1).a
OF_LAB := tools/bench/measure/run.c tools/bench/study/baseline.c tools/masu/study_march.c tools/masu/study_baseline.c
tool_sources = $(filter-out %/main.c $(OF_LAB),$(wildcard tools/$(1)/*.c tools/$(1)/*/*.c))
TOOL_FOLDERS := cli spirv sdfc bake meso world metric bench model isa conform simulate
$(foreach f,$(TOOL_FOLDERS),$(eval $(call tool_archive,$(f)): $(call objects,$(call tool_sources,$(f)))))

$(call tool_archive,bake): $(BUILD)/obj/tools/bake/import/gltf_draco.o

PLATFORM  := $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
BAKE_ARCHIVES := $(foreach f,bake sdfc spirv cli,$(call tool_archive,$(f))) $(PLATFORM)
MEASURE_ARCHIVES := $(foreach f,conform bench model isa simulate metric,$(call tool_archive,$(f)))

# Where ImageMagick has its headers differs by machine. Its headers are not ours to warn about.
$(BUILD)/obj/tools/bake/texture/image.o: FOLDER_FLAGS += $$(pkg-config --cflags MagickWand | \
    sed 's/-I/-isystem /g; s/-fopenmp//g')
BAKE_LIBS := -lassimp -ljansson -lmeshoptimizer -ldraco -lembree3 $$(pkg-config --libs MagickWand) -lm -lpthread -lstdc++
MASU_LIBS := -lvulkan -ljansson -lembree3 -lm -ldl -lpthread

# ---- Programs ------------------------------------------------------------------------------------

$(BUILD)/bin/masu: LIBS = $(MASU_LIBS)
$(BUILD)/bin/masu: $(call objects,$(filter-out $(OF_LAB),$(wildcard tools/masu/*.c))) $(KEEP_LOADED) $(MEASURE_ARCHIVES) $(BAKE_ARCHIVES)
	$(link)

$(BUILD)/bin/masu-bake $(BUILD)/bin/masu-meso $(BUILD)/bin/masu-world: LIBS = $(BAKE_LIBS)
$(BUILD)/bin/masu-bake: $(BUILD)/obj/tools/bake/main.o $(BAKE_ARCHIVES)
	$(link)
$(BUILD)/bin/masu-meso: $(BUILD)/obj/tools/meso/main.o $(call tool_archive,meso) $(BAKE_ARCHIVES)
	$(link)
$(BUILD)/bin/masu-world: $(BUILD)/obj/tools/world/main.o $(call tool_archive,world) $(BAKE_ARCHIVES)
	$(link)

$(BUILD)/bin/masu-sdfc: LIBS = -lm
$(BUILD)/bin/masu-sdfc: $(BUILD)/obj/tools/sdfc/main.o $(call tool_archive,sdfc) $(call tool_archive,cli)
	$(link)

# masu-view takes SDL2 and a font, which nothing else does: `make view` installs them, and without them the
# other programs are built all the same.
VIEW_FONT  := /usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf
SDL_CFLAGS := $$(pkg-config --cflags sdl2 | sed 's/-I/-isystem /g')
HAVE_SDL2  := $(wildcard $(addsuffix /SDL2/SDL.h,/usr/include /usr/local/include))
HAVE_VIEW  := $(and $(HAVE_SDL2),$(wildcard $(VIEW_FONT)))
VIEW_OBJECTS := $(call objects,$(wildcard tools/view/*.c) tools/masu/options.c)

$(BUILD)/obj/tools/view/%.o: FOLDER_FLAGS += $(SDL_CFLAGS)
$(BUILD)/obj/tools/view/canvas.o: $(MADE)/gen/view_font.h
$(MADE)/gen/view_font.h: $(MADE)/tools/make_font
	@mkdir -p $(@D)
	@echo "  TABLE   $@"
	$(V)$< $(VIEW_FONT) > $@
$(BUILD)/bin/masu-view: LIBS = $(MASU_LIBS) $$(pkg-config --libs sdl2)
$(BUILD)/bin/masu-view: $(VIEW_OBJECTS) $(KEEP_LOADED) $(MEASURE_ARCHIVES) $(BAKE_ARCHIVES)
	$(link)

# ---- Suites: beside the programs, where masu conform looks for them ------------------------------

SUITES := $(patsubst %,$(BUILD)/%,$(wildcard suites/*.json))
$(BUILD)/suites/%.json: suites/%.json
	@mkdir -p $(@D)
	$(V)cp $< $@

# ---- Tables in documents -------------------------------------------------------------------------

# Committed, for readers; tests/scripts/docs_tables.sh fails where they are not what the headers say.
.PHONY: docs-tables
docs-tables: $(BUILD)/bin/masu ## write docs/knobs.md and docs/passes.md from their tables
	$(V)$(BUILD)/bin/masu plan --knobs=md > docs/knobs.md.new
	$(V)mv docs/knobs.md.new docs/knobs.md
	$(V)shaders/tables.sh passes > docs/passes.md.new
	$(V)mv docs/passes.md.new docs/passes.md

# ---- Scenes --------------------------------------------------------------------------------------

# Those worth looking at are in scenes/, those of the tests in tests/scenes/; their blobs lie side by
# side. A scene is baked again when any file of its folder changes: descriptions name models and GLSL
# that lie beside them.
SCENES := $(patsubst %.json,$(MADE)/scenes/%.masu,$(notdir $(wildcard scenes/*.json tests/scenes/*.json)))

define scene_rule
$(MADE)/scenes/%.masu: $(1)/%.json $(MADE)/bin/masu-bake $(wildcard $(1)/*.*) $(MADE)/textures/made
	@mkdir -p $$(@D)
	@echo "  BAKE    $$<"
	$$(V)$$(SANITIZER_ENV) $(MADE)/bin/masu-bake $$< -o $$@ --texture-path $(MADE)/textures
endef
$(foreach f,scenes tests/scenes,$(eval $(call scene_rule,$(f))))

# The pictures that scenes/textures.json and the tests place: made here, by formula.
# stb's JPEG writer shifts bits out of signed integers.
$(MADE)/obj/tools/generate/make_textures.o: FOLDER_FLAGS += -fno-sanitize=shift
$(MADE)/tools/make_textures: LIBS = -lm
$(MADE)/tools/make_textures: $(MADE)/obj/tools/generate/make_textures.o
	$(link)
$(MADE)/textures/made: $(MADE)/tools/make_textures
	@mkdir -p $(@D)
	$(V)$< $(@D)
	$(V)touch $@

# Worlds are written by masu-world and baked like any scene. Not part of `all` or of the tests.
WORLDS     := city forza
TORCS      ?= /usr/share/games/torcs
TIME_city  := 1
TIME_forza := 0.7

$(BUILD)/worlds/city/city.json: $(BUILD)/bin/masu-world
	@mkdir -p $(@D)
	$(V)$(BUILD)/bin/masu-world city $(@D) --quiet
$(BUILD)/worlds/forza/forza.json: $(BUILD)/bin/masu-world
	@mkdir -p $(@D)
	$(V)$(BUILD)/bin/masu-world forza $(@D) --torcs '$(TORCS)'
FORZA_RELIEFS := $(foreach r,asphalt grass gravel,$(BUILD)/worlds/forza/$(r).json)
$(FORZA_RELIEFS): $(BUILD)/worlds/forza/%.json: $(BUILD)/bin/masu-meso
	@mkdir -p $(@D)
	@echo "  MESO    $*"
	$(V)cd $(@D) && $(abspath $(BUILD)/bin/masu-meso) --make $* -o $* --no-plots > /dev/null
$(BUILD)/worlds/forza.masu: $(FORZA_RELIEFS)

.PHONY: $(WORLDS:%=world-%)
$(WORLDS:%=world-%): world-%: $(BUILD)/worlds/%.masu
define world_rule
$(BUILD)/worlds/$(1).masu: $(BUILD)/worlds/$(1)/$(1).json $(BUILD)/bin/masu-bake
	@echo "  BAKE    $$<"
	$$(V)$(BUILD)/bin/masu-bake $$< -o $$@ --stats $$(@:.masu=.stats.json)
endef
$(foreach w,$(WORLDS),$(eval $(call world_rule,$(w))))

# The example of the README.
$(BUILD)/examples/%: LIBS = -lvulkan -lm
$(BUILD)/examples/%: $(BUILD)/obj/examples/%.o $(KEEP_LOADED) $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/examples/%,$(wildcard examples/*.c))

# Those with a window are of masu.h, Vulkan, SDL2 and examples/shared alone; where there is no SDL2 they are left
# out. What the game and the library ask of the heap goes to examples/drive/heap.c.
WINDOW_EXAMPLES := $(addprefix $(BUILD)/examples/,drive loop)
WINDOW_FLAGS    := -Iexamples/shared $$(pkg-config --cflags sdl2)
EXAMPLES := $(filter-out $(if $(HAVE_SDL2),,$(WINDOW_EXAMPLES)),$(EXAMPLES) $(BUILD)/examples/drive)
$(BUILD)/obj/examples/drive/%.o $(BUILD)/obj/examples/shared/%.o $(BUILD)/obj/examples/loop.o: FOLDER_FLAGS += $(WINDOW_FLAGS)
$(WINDOW_EXAMPLES): LIBS = $(HEAP_FLAGS) $$(pkg-config --libs sdl2) -lvulkan -lm
$(WINDOW_EXAMPLES): $(call objects,$(wildcard examples/shared/*.c)) $(KEEP_LOADED) $(BUILD)/lib/libmasu.a
$(BUILD)/examples/drive: HEAP_FLAGS = $(patsubst %,-Wl$(comma)--wrap=%,malloc calloc realloc)
$(BUILD)/examples/drive: $(call objects,$(wildcard examples/drive/*.c))
	$(link)
$(BUILD)/worlds/forza.track: $(BUILD)/worlds/forza/forza.json
	$(V)cp $(@D)/forza/forza.track $@

# For masu study march: each .sdf scene with all ways to march it, and its double-precision truth
# beside it. Not part of `all` or of the tests.
MARCH_SCENES := $(patsubst scenes/%.sdf,$(BUILD)/march/%.masu,$(wildcard scenes/*.sdf))

$(BUILD)/march/%.masu: scenes/%.json scenes/%.sdf $(BUILD)/bin/masu-bake
	@mkdir -p $(@D)
	@echo "  BAKE    $< --variants"
	$(V)$(BUILD)/bin/masu-bake $< -o $@ --variants --quiet

$(BUILD)/march/%.truth.c: scenes/%.sdf $(BUILD)/bin/masu-sdfc
	@mkdir -p $(@D)
	$(V)$(BUILD)/bin/masu-sdfc $< --c $@ --quiet

%.truth.so: %.truth.c
	@echo "  TRUTH   $@"
	$(V)$(CC) -std=c11 -O2 -w -shared -fPIC -o $@ $< -lm

# Scenes with the plain march, for masu study baseline.
$(BUILD)/march/engine.masu: scenes/engine.json scenes/engine.glsl $(BUILD)/bin/masu-bake
	@mkdir -p $(@D)
	@echo "  BAKE    $< --variants"
	$(V)$(BUILD)/bin/masu-bake $< -o $@ --variants --quiet

# ---- Studies -------------------------------------------------------------------------------------

# masu study $(STUDY) on each of its scenes, folders and names below $(BUILD), with STUDY_ARGS. The worlds
# are measured if they are baked (make worlds); forza is seen beside a car. Those of `march` are one run,
# which sums them up; `upscale` has a picture of its own.
.PHONY: study
STUDY ?= march
baked_worlds = $(patsubst $(BUILD)/%.masu,%,$(wildcard $(WORLDS:%=$(BUILD)/worlds/%.masu)))
SCENES_march       := $(MARCH_SCENES:$(BUILD)/%.masu=%)
SCENES_cull        := scenes/test_town $(baked_worlds)
SCENES_draw        := scenes/engine $(baked_worlds)
SCENES_lights      := scenes/night
SCENES_ao          := scenes/engine
SCENES_reflections := scenes/mirrors
SCENES_rays        := scenes/test_trace scenes/mirrors
SCENES_image       := scenes/engine
SCENES_baseline    := march/engine march/city march/wet_city scenes/mirrors $(baked_worlds)
STUDY_SCENES ?= $(SCENES_$(STUDY))
study_blobs = $(STUDY_SCENES:%=$(BUILD)/%.masu)
study_truths = $(if $(filter march,$(STUDY)),$(study_blobs:.masu=.truth.so))
study: $(BUILD)/bin/masu $(study_blobs) $(study_truths) ## masu study on its scenes: STUDY=march STUDY_SCENES='march/city' STUDY_ARGS=
ifeq ($(STUDY),march)
	$(V)$(BUILD)/bin/masu study march $(study_blobs) $(STUDY_ARGS)
else ifeq ($(STUDY),upscale)
	$(V)$(BUILD)/bin/masu study upscale $(STUDY_ARGS)
else
	$(V)mkdir -p $(BUILD)/study
	$(V)for s in $(STUDY_SCENES); do \
	    set -- ; [ $(STUDY) != baseline ] || { \
	        time=1; [ $$s != worlds/forza ] || time=146.5; \
	        to=$(BUILD)/study/baseline-$$(echo $$s | tr / -); \
	        set -- --time $$time --truth $$to.truth.png --csv $$to.csv; }; \
	    $(BUILD)/bin/masu study $(STUDY) $(BUILD)/$$s.masu "$$@" $(STUDY_ARGS) || exit 1; \
	done
endif

# ---- What GPUs' compilers make of the shaders ----------------------------------------------------

# Without MASU_ISA_DRIVERS the rows of other GPUs than RADV's stay as they are.
comma    := ,
ISA_GPUS := vangogh,raven$(if $(MASU_ISA_DRIVERS),$(comma)skl$(comma)kbl$(comma)tgl$(comma)a630$(comma)a660)
.PHONY: isa-table
isa-table: $(BUILD)/bin/masu $(SCENES) ## write docs/report/isa.csv: every pipeline on the GPUs that the project is for
	$(V)BUILD=$(BUILD) MADE=$(MADE) tools/isa/table.sh $(ISA_GPUS) > $(BUILD)/isa.csv
	$(V)test -n '$(MASU_ISA_DRIVERS)' || awk -F, '$$2 ~ /^(skl|kbl|tgl|a630|a660)$$/' docs/report/isa.csv >> $(BUILD)/isa.csv
	$(V)mv $(BUILD)/isa.csv docs/report/isa.csv

.PHONY: isa-drivers
isa-drivers: ## build Intel's and Adreno's compilers for MASU_ISA_DRIVERS=build/isa-drivers (ten minutes)
	$(call install-packages,$(PACKAGES_isa))
	$(V)tools/isa/drivers.sh build/isa-drivers
