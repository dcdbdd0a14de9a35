# tools.mk: the programs. masu-meso is meso.c and meso_*.c. masu is masu.c and one cmd_NAME.c per command, with
# conform_*.c behind one of them, masu-bake is bake.c and
# bake_*.c, masu-sdfc is sdfc.c; the compiler itself, sdfc_*.c, is also part of masu-bake. cli*.c
# belong to all.

CLI_OBJECTS := $(call objects,$(wildcard tools/cli*.c))
SDFC_OBJECTS := $(call objects,$(wildcard tools/sdfc_*.c))

$(BUILD)/bin/masu-sdfc: LIBS = -lm
$(BUILD)/bin/masu-sdfc: $(call objects,tools/sdfc.c) $(SDFC_OBJECTS) $(CLI_OBJECTS)
	$(link)

$(BUILD)/bin/masu: LIBS = -lvulkan -ljansson -lembree3 -lm -ldl -lpthread
$(BUILD)/bin/masu: $(call objects,$(wildcard tools/masu.c tools/cmd_*.c tools/conform_*.c)) $(CLI_OBJECTS)
$(BUILD)/bin/masu: $(call objects,tools/bake_content.c tools/bake_groups.c) # a tree for cull-bench
$(BUILD)/bin/masu: $(KEEP_LOADED) $(BUILD)/lib/libmasu-bench.a $(BUILD)/lib/libmasu-plant.a
$(BUILD)/bin/masu: $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

# What masu measures with, for the tests too.
$(BUILD)/lib/libmasu-bench.a: $(call objects,$(wildcard tools/bench_*.c tools/metric_*.c))
$(BUILD)/lib/libmasu-bench.a: $(call objects,$(wildcard tools/model_*.c tools/spirv*.c))

# Where ImageMagick has its headers differs by machine. Its headers are not ours to warn about.
$(BUILD)/obj/tools/bake_image.o: FOLDER_FLAGS += $$(pkg-config --cflags MagickWand | \
    sed 's/-I/-isystem /g; s/-fopenmp//g')
BAKE_LIBS := -lassimp -ljansson -lmeshoptimizer -lembree3 $$(pkg-config --libs MagickWand) -lm -lpthread
$(BUILD)/bin/masu-bake: LIBS = $(BAKE_LIBS)
$(BUILD)/bin/masu-bake: $(call objects,$(wildcard tools/bake.c tools/bake_*.c) tools/probe_light.c) $(CLI_OBJECTS) $(SDFC_OBJECTS)
$(BUILD)/bin/masu-bake: $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

# Embree traces the reliefs; a user of the patches and of what is made of them links MESO_OBJECTS.
MESO_OBJECTS := $(call objects,$(wildcard tools/meso_*.c))
MESO_LIBS := -lembree3 $(BAKE_LIBS)
$(BUILD)/bin/masu-meso: LIBS = $(MESO_LIBS)
$(BUILD)/bin/masu-meso: $(call objects,tools/meso.c $(wildcard tools/bake_*.c) tools/probe_light.c) $(MESO_OBJECTS)
$(BUILD)/bin/masu-meso: $(CLI_OBJECTS) $(SDFC_OBJECTS)
$(BUILD)/bin/masu-meso: $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

# Writes the scenes of whole worlds; reads models as masu-bake does.
$(BUILD)/bin/masu-world: LIBS = $(BAKE_LIBS)
$(BUILD)/bin/masu-world: $(call objects,$(wildcard tools/world.c tools/world_*.c)) $(CLI_OBJECTS)
$(BUILD)/bin/masu-world: $(call objects,$(wildcard tools/bake_*.c) tools/probe_light.c) $(SDFC_OBJECTS)
$(BUILD)/bin/masu-world: $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

# A scene is baked again when any file of scenes/ changes: descriptions name models and GLSL that
# lie beside them.
SCENES := $(patsubst scenes/%.json,$(BUILD)/scenes/%.masu,$(wildcard scenes/*.json))

$(BUILD)/scenes/%.masu: scenes/%.json $(BUILD)/bin/masu-bake $(wildcard scenes/*.* scenes/*/*.*) $(BUILD)/textures/made
	@mkdir -p $(@D)
	@echo "  BAKE    $<"
	$(V)$(SANITIZER_ENV) $(BUILD)/bin/masu-bake $< -o $@ --texture-path $(BUILD)/textures

# The pictures that scenes/textures.json and the tests place: made here, by formula.
# stb's JPEG writer shifts bits out of signed integers.
$(BUILD)/obj/tools/make_textures.o: FOLDER_FLAGS += -fno-sanitize=shift
$(BUILD)/tools/make_textures: LIBS = -lm
$(BUILD)/tools/make_textures: $(BUILD)/obj/tools/make_textures.o
	$(link)
$(BUILD)/textures/made: $(BUILD)/tools/make_textures
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

# For masu march-bench: each .sdf scene with all ways to march it, and its double-precision truth
# beside it. Not part of `all` or of the tests.
MARCH_SCENES := $(patsubst scenes/%.sdf,$(BUILD)/march/%.masu,$(filter-out scenes/test_%,$(wildcard scenes/*.sdf)))

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

.PHONY: march-bench
MARCH_ARGS ?= --size 960x540
march-bench: $(BUILD)/bin/masu $(MARCH_SCENES) $(MARCH_SCENES:.masu=.truth.so) ## measure the ways to march the SDF: MARCH_ARGS='--size 960x540 --csv FILE'
	$(V)$(BUILD)/bin/masu march-bench $(MARCH_SCENES) $(MARCH_ARGS)

# For masu whole-bench: scenes with the plain march; WHOLE: folders and names below $(BUILD). The worlds are
# measured if they are baked (make worlds). Forza is seen beside a car.
$(BUILD)/march/engine.masu: scenes/engine.json scenes/engine.glsl $(BUILD)/bin/masu-bake
	@mkdir -p $(@D)
	@echo "  BAKE    $< --variants"
	$(V)$(BUILD)/bin/masu-bake $< -o $@ --variants --quiet

.PHONY: whole-bench
WHOLE ?= march/engine march/city march/wet_city scenes/mirrors \
    $(patsubst $(BUILD)/%.masu,%,$(wildcard $(WORLDS:%=$(BUILD)/worlds/%.masu)))
WHOLE_ARGS ?= --size 640x360
whole-bench: $(BUILD)/bin/masu $(WHOLE:%=$(BUILD)/%.masu) ## whole frames against a plain renderer, on scenes and worlds: WHOLE='march/city' WHOLE_ARGS=
	$(V)mkdir -p $(BUILD)/whole
	$(V)for s in $(WHOLE); do \
	    time=1; [ $$s != worlds/forza ] || time=146.5; to=$(BUILD)/whole/$$(echo $$s | tr / -); \
	    $(BUILD)/bin/masu whole-bench $(BUILD)/$$s.masu --time $$time --truth $$to.truth.png \
	        --csv $$to.csv $(WHOLE_ARGS) || exit 1; \
	done
