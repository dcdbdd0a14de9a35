# tools.mk: the programs. masu is masu.c and one cmd_NAME.c per command, masu-bake is bake.c and
# bake_*.c; cli*.c belong to both.

CLI_OBJECTS := $(call objects,$(wildcard tools/cli*.c))

$(BUILD)/bin/masu: LIBS = -lvulkan -ljansson -lm
$(BUILD)/bin/masu: $(call objects,$(wildcard tools/masu.c tools/cmd_*.c)) $(CLI_OBJECTS)
$(BUILD)/bin/masu: $(KEEP_LOADED) $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

$(BUILD)/bin/masu-bake: LIBS = -lassimp -ljansson -lm
$(BUILD)/bin/masu-bake: $(call objects,$(wildcard tools/bake.c tools/bake_*.c)) $(CLI_OBJECTS)
$(BUILD)/bin/masu-bake: $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)

# A scene is baked again when any file of scenes/ changes: descriptions name models and GLSL that
# lie beside them.
SCENES := $(patsubst scenes/%.json,$(BUILD)/scenes/%.masu,$(wildcard scenes/*.json))

$(BUILD)/scenes/%.masu: scenes/%.json $(BUILD)/bin/masu-bake $(wildcard scenes/*.* scenes/*/*.*)
	@mkdir -p $(@D)
	@echo "  BAKE    $<"
	$(V)$(SANITIZER_ENV) $(BUILD)/bin/masu-bake $< -o $@

# The example of the README.
$(BUILD)/examples/%: LIBS = -lvulkan -lm
$(BUILD)/examples/%: $(BUILD)/obj/examples/%.o $(KEEP_LOADED) $(BUILD)/lib/libmasu-platform.a $(BUILD)/lib/libmasu.a
	$(link)
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/examples/%,$(wildcard examples/*.c))
