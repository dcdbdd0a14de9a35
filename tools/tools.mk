# tools.mk: the programs, and the archives that they and the tests share. A folder of tools/ is one archive; a
# program is its main file and the archives of the functions that it calls, from which the linker takes the objects
# that it needs.

# ---- Archives: one per folder of tools/ ----------------------------------------------------------

tool_archive = $(BUILD)/lib/libmasu-$(1).a
tool_sources = $(filter-out %/main.c,$(wildcard tools/$(1)/*.c tools/$(1)/*/*.c))
TOOL_FOLDERS := cli command settings spirv sdfc bake meso metric measure bench conform
$(foreach f,$(TOOL_FOLDERS),$(eval $(call tool_archive,$(f)): $(call objects,$(call tool_sources,$(f)))))

$(call tool_archive,bake): $(BUILD)/obj/tools/bake/import/gltf_draco.o

PLATFORM  := $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
BAKE_ARCHIVES := $(foreach f,bake sdfc spirv cli,$(call tool_archive,$(f))) $(PLATFORM)
MEASURE_ARCHIVES := $(foreach f,command conform bench measure settings metric,$(call tool_archive,$(f)))

# The path of ImageMagick's headers depends on the machine. Warnings in them are not ours.
$(BUILD)/obj/tools/bake/texture/image.o: FOLDER_FLAGS += $$(pkg-config --cflags MagickWand | \
    sed 's/-I/-isystem /g; s/-fopenmp//g')
BAKE_LIBS := -lassimp -ljansson -lmeshoptimizer -ldraco -lembree3 $$(pkg-config --libs MagickWand) -lm -lpthread -lstdc++
MASU_LIBS := -lvulkan -ljansson -lembree3 -lm -ldl -lpthread

# ---- Suites: next to the programs, where masu conform looks for them -----------------------------

SUITES := $(patsubst %,$(BUILD)/%,$(wildcard suites/*.json))
$(BUILD)/suites/%.json: suites/%.json
	@mkdir -p $(@D)
	$(V)cp $< $@

# ---- Programs ------------------------------------------------------------------------------------

$(BUILD)/bin/masu: LIBS = $(MASU_LIBS)
$(BUILD)/bin/masu: $(call objects,$(wildcard tools/masu/*.c)) $(KEEP_LOADED) $(MEASURE_ARCHIVES) $(BAKE_ARCHIVES) | $(SUITES)
	$(link)

$(BUILD)/bin/masu-bake $(BUILD)/bin/masu-meso: LIBS = $(BAKE_LIBS)
$(BUILD)/bin/masu-bake: $(BUILD)/obj/tools/bake/main.o $(BAKE_ARCHIVES)
	$(link)
$(BUILD)/bin/masu-meso: $(BUILD)/obj/tools/meso/main.o $(call tool_archive,meso) $(BAKE_ARCHIVES)
	$(link)
$(BUILD)/bin/masu-sdfc: LIBS = -lm
$(BUILD)/bin/masu-sdfc: $(BUILD)/obj/tools/sdfc/main.o $(call tool_archive,sdfc) $(call tool_archive,cli) $(PLATFORM)
	$(link)

# Only masu-view needs SDL2, Dear ImGui and a font: `make view` installs them, and without them
# the other programs are built.
VIEW_FONT  := /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
SDL_CFLAGS := $$(pkg-config --cflags sdl2 | sed 's/-I/-isystem /g')
IMGUI_CFLAGS := $$(pkg-config --cflags imgui | sed 's/-I/-isystem /g') -DMASU_UI_FONT='"$(VIEW_FONT)"'
HAVE_SDL2  := $(wildcard $(addsuffix /SDL2/SDL.h,/usr/include /usr/local/include))
HAVE_IMGUI := $(wildcard $(addsuffix /imgui/backends/imgui_impl_vulkan.h,/usr/include /usr/local/include))
HAVE_VIEW  := $(and $(HAVE_SDL2),$(HAVE_IMGUI),$(wildcard $(VIEW_FONT)))
VIEW_OBJECTS := $(call objects,$(wildcard tools/view/*.c)) $(BUILD)/obj/tools/view/ui.o

$(BUILD)/obj/tools/view/%.o: FOLDER_FLAGS += $(SDL_CFLAGS)
$(BUILD)/obj/tools/view/ui.o: private CXXFLAGS += $(SDL_CFLAGS) $(IMGUI_CFLAGS)
$(BUILD)/bin/masu-view: LIBS = $(MASU_LIBS) $$(pkg-config --libs sdl2) -limgui -l:libstb.a -lstdc++
$(BUILD)/bin/masu-view: $(VIEW_OBJECTS) $(KEEP_LOADED) $(MEASURE_ARCHIVES) $(BAKE_ARCHIVES)
	$(link)

# ---- Tables in documents -------------------------------------------------------------------------

# Committed, for readers; tests/scripts/docs_tables.sh fails if they differ from the headers.
# The structs of masu_knobs.h come first, because the rest is compiled from them.
.PHONY: docs-tables struct-tables
struct-tables:
	@mkdir -p $(BUILD)/tools
	$(V)$(CC) -std=c11 -DMASU_LAB -Iinclude tools/generate/make_structs.c -o $(BUILD)/tools/make_structs
	$(V)$(BUILD)/tools/make_structs < include/masu_knobs.h > $(BUILD)/masu_knobs.h
	$(V)cmp -s $(BUILD)/masu_knobs.h include/masu_knobs.h || cp $(BUILD)/masu_knobs.h include/masu_knobs.h
docs-tables: struct-tables $(BUILD)/bin/masu $(BUILD)/bin/masu-sdfc ## write masu_rung in masu_knobs.h, docs/knobs.md, passes.md, sdf-shapes.md and the table of glTF in scene.md
	$(V)$(BUILD)/bin/masu plan --knobs=md > docs/knobs.md.new
	$(V)mv docs/knobs.md.new docs/knobs.md
	$(V)shaders/tables.sh passes > docs/passes.md.new
	$(V)mv docs/passes.md.new docs/passes.md
	$(V)$(BUILD)/bin/masu-sdfc --shapes > docs/sdf-shapes.md.new
	$(V)mv docs/sdf-shapes.md.new docs/sdf-shapes.md
	$(V)tools/bake/import/features.sh --into docs/scene.md > docs/scene.md.new
	$(V)mv docs/scene.md.new docs/scene.md

# ---- Scenes --------------------------------------------------------------------------------------

# Scenes to look at are in scenes/, the tests' in tests/scenes/; their blobs share one folder. A scene is baked again
# when its description, a file that it names or the code of masu-bake changes.
SCENE_JSON := $(wildcard scenes/*.json tests/scenes/*.json)
SCENES     := $(patsubst %.json,$(MADE)/scenes/%.masu,$(notdir $(SCENE_JSON)))
scene_needs = $(subst $(comma), ,$(word 2,$(subst :, ,$(1))))
define scene_rule
$(MADE)/scenes/$(basename $(notdir $(firstword $(subst :, ,$(1))))).masu: $(firstword $(subst :, ,$(1))) $(scene_needs) \
    $(MADE)/bin/masu-bake.code $(MADE)/textures/made
	@mkdir -p $$(@D)
	@echo "  BAKE    $$<"
	$$(V)$$(BAKE_ENV) $(MADE)/bin/masu-bake $$< -o $$@ --texture-path $(MADE)/textures
endef
$(foreach n,$(shell scenes/needs.sh scenes tests/scenes),$(eval $(call scene_rule,$(n))))

# The hash of the program code of masu-bake: it does not change with comments in its sources.
$(MADE)/bin/masu-bake.code: $(MADE)/bin/masu-bake
	$(V)objcopy --strip-all -R .note.gnu.build-id $< $@.stripped
	$(V)cksum < $@.stripped > $@.new && rm $@.stripped
	$(V)$(call move_if_changed,$@.new,$@)

# The textures of scenes/textures.json and of the tests, generated here by formulas.
# stb's JPEG writer shifts bits out of signed integers.
$(MADE)/obj/tools/generate/make_textures.o: FOLDER_FLAGS += -fno-sanitize=shift
$(MADE)/tools/make_textures: LIBS = -lm
$(MADE)/tools/make_textures: $(MADE)/obj/tools/generate/make_textures.o
	$(link)
$(MADE)/textures/made: $(MADE)/tools/make_textures
	@mkdir -p $(@D)
	$(V)$< $(@D)
	$(V)touch $@

# Worlds are written by a program of the lab (lab/lab.mk). Not part of `all` or of the tests.
WORLDS     := city city_night forza forza_night
TORCS      ?= /usr/share/games/torcs
TIME_city  := 1
TIME_forza := 0.7
TIME_city_night  := $(TIME_city)
TIME_forza_night := $(TIME_forza)

# The example of the README.
$(BUILD)/examples/%: LIBS = -lvulkan -lm
$(BUILD)/examples/%: $(BUILD)/obj/examples/%.o $(KEEP_LOADED) $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/examples/%,$(wildcard examples/*.c))

# Examples with a window use only masu.h, Vulkan, SDL2 and examples/shared; without SDL2 they are not
# built. Allocations of the game and the library are redirected to examples/drive/heap.c.
WINDOW_EXAMPLES := $(addprefix $(BUILD)/examples/,drive loop)
WINDOW_FLAGS    := -Iexamples/shared $$(pkg-config --cflags sdl2)
EXAMPLES := $(filter-out $(if $(HAVE_SDL2),,$(WINDOW_EXAMPLES)),$(EXAMPLES) $(BUILD)/examples/drive)
$(BUILD)/obj/examples/drive/%.o $(BUILD)/obj/examples/shared/%.o $(BUILD)/obj/examples/loop.o: FOLDER_FLAGS += $(WINDOW_FLAGS)
$(WINDOW_EXAMPLES): LIBS = $(HEAP_FLAGS) $$(pkg-config --libs sdl2) -lvulkan -lm
$(WINDOW_EXAMPLES): $(call objects,$(wildcard examples/shared/*.c)) $(KEEP_LOADED) $(BUILD)/lib/libmasu.a
$(BUILD)/examples/drive: HEAP_FLAGS = $(patsubst %,-Wl$(comma)--wrap=%,malloc calloc realloc)
$(BUILD)/examples/drive: $(call objects,$(wildcard examples/drive/*.c))
	$(link)
# A scene's field in double precision (masu-sdfc --c), next to the scene as NAME.truth.so.
%.truth.so: %.truth.c
	@echo "  TRUTH   $@"
	$(V)$(CC) -std=c11 -O3 -w -shared -fPIC -o $@ $< -lm
