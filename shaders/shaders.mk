# shaders.mk: GLSL to SPIR-V to C.
#
#   shaders/NAME.STAGE -> gen/NAME_STAGE.spv      with debug names: tests read struct offsets there
#                      -> gen/NAME_STAGE.opt.spv  optimised, stripped, vectors of buffers loaded whole
#                      -> gen/packed.h            all of the library, packed (src/device/unpack.h)
#                      -> gen/NAME_STAGE.spv.h    one of tools or tests, as `const uint32_t masu_spv_NAME_STAGE[]`
#
# Both SPIR-V files pass spirv-val. Shaders of tests/gpu and tools/view are compiled the same way. A scene shader
# is not complete without the GLSL of a scene: masu-bake compiles it, so it and all that it may
# include are embedded as text instead.
#
# Compute and fragment shaders are of version 440 but for those with 16-bit floats or ray queries. The optimised SPIR-V is
# the same to the byte, and glslang takes 0.08 s instead of 0.17 to start: for 450 it declares twice as many functions before
# the first line.
# Vertex shaders are of 450: for 440 they declare a block for the position that has no cull distance.

SCENE_SHADERS := update.comp classify.comp cone.comp march.comp march_plain.comp march_seed.comp \
    march_checkerboard.comp sdf_velocity.comp sdf_occlusion.comp \
    silhouettes.comp local_shadow_sdf.comp \
    specular_trace_sdf.comp bounce_sdf.comp
# Of these, the marches that only the lab build has: masu-bake holds their text only with MASU_LAB.
LAB_SCENE_SHADERS := march_plain.comp march_seed.comp march_checkerboard.comp

SPIRV_TARGET := --target-env vulkan1.1
STAGES       := comp vert frag

SHADERS := $(filter-out $(SCENE_SHADERS:%=shaders/%),$(wildcard $(STAGES:%=shaders/*.%)))
SHADERS += $(wildcard $(STAGES:%=tests/gpu/*.%) $(STAGES:%=tools/view/*.%) $(STAGES:%=examples/*.%))

# Derived from the rows of the frame's tables by shell and awk: bindings, push constants, the permutations of every
# shader and how each is compiled.
TABLE_ROWS := shaders/tables.sh $(addprefix src/plan/,passes.inc axes.inc buffers.inc)
PUSHES     := $(shell shaders/tables.sh pushes)
TABLE_HEADERS := $(addprefix $(MADE)/gen/,bindings.h push_constants.h $(PUSHES:%=push/%.h))

# Derived files are written only if their content changes; the stamp says that they are up to date. An edited comment in a
# shader, a shared header or a table therefore compiles no shader: glslang reads copies without comments (gen/glsl).
GLSL_SOURCES := $(wildcard $(STAGES:%=shaders/*.%) shaders/*/*.h shaders/*/*.glsl)
GLSL_SOURCES += $(wildcard $(STAGES:%=tests/gpu/*.%) $(STAGES:%=tools/view/*.%) $(STAGES:%=examples/*.%))
$(MADE)/gen/glsl.stamp: $(TABLE_ROWS) shaders/strip.sh $(GLSL_SOURCES) $(MADE)/gen/glsl.list
	@mkdir -p $(@D)
	$(V)shaders/tables.sh headers $(MADE)/gen
	$(V)shaders/tables.sh permutations > $(MADE)/gen/permutations.new
	$(V)$(call move_if_changed,$(MADE)/gen/permutations.new,$(MADE)/gen/permutations.h)
	$(V)shaders/strip.sh $(MADE)/gen/glsl $(GLSL_SOURCES)
	$(V)touch $@
$(TABLE_HEADERS) $(MADE)/gen/permutations.h: $(MADE)/gen/glsl.stamp ;
$(patsubst %,$(MADE)/gen/glsl/%,$(patsubst shaders/%,%,$(GLSL_SOURCES))): $(MADE)/gen/glsl.stamp ;

# The list changes when a source is added or removed.
$(MADE)/gen/glsl.list: force
	@$(call keep_text,$(GLSL_SOURCES))

# move_if_changed NEW,FILE
move_if_changed = if cmp -s $(1) $(2); then rm $(1); else mv $(1) $(2); fi

# Lines NAME_STAGE:FILE:MACRO+MACRO; those with macros have rules of their own. One more: rays for the tests
# and for masu-lab study, with counters.
BUILDS       := $(shell shaders/tables.sh builds)
PACKED       := $(foreach b,$(BUILDS),$(firstword $(subst :, ,$(b))))
PERMUTATIONS := $(filter-out %:,$(BUILDS))
PERMUTATIONS += trace_rays_counted_comp:trace_rays.comp:MASU_TRACE_COUNTERS

# Classes of scenes (masu_scene_class of masu.h) that the library is for; what none of them has a use for is left
# out, and scenes that need it are refused. left_out CLASSES: the permutations.
ALL_CLASSES := polygons world sdf both polygons-traced world-traced sdf-traced both-traced
CLASSES     ?= all
ifneq ($(filter-out all $(ALL_CLASSES),$(CLASSES)),)
$(error CLASSES has $(filter-out all $(ALL_CLASSES),$(CLASSES)): known are all, $(ALL_CLASSES))
endif
PARTS        := $(shell shaders/tables.sh parts)
parts_of      = $(if $(filter all %-traced,$(1)),traced) $(if $(filter all polygons% world% both%,$(1)),polygons)
left_out      = $(foreach p,$(PARTS),$(if $(filter-out $(call parts_of,$(1)),$(subst +, ,$(lastword $(subst :, ,$p)))),$(firstword $(subst :, ,$p))))

# dir/NAME.STAGE is NAME_STAGE
SPIRV         := $(foreach s,$(notdir $(SHADERS)),$(MADE)/gen/$(subst .,_,$(s)).opt.spv)
SPIRV         += $(foreach b,$(PERMUTATIONS),$(MADE)/gen/$(firstword $(subst :, ,$(b))).opt.spv)
SPIRV_HEADERS := $(addprefix $(MADE)/gen/,$(sort $(shell grep -rhoE '\b[a-z0-9_]+\.spv\.h' --include='*.[ch]' tools tests examples)))
# The slow ones first: nothing is compiled before the last of them is there.
GENERATED     := $(patsubst %,$(MADE)/gen/%.h,blue_noise split_sum smaa_area permutations scene_sources packed)
GENERATED     += $(SPIRV_HEADERS) $(SPIRV)

# glslang's dependency file has no empty rules for included files; without them, the next make would fail after a file
# is removed. Errors are printed with the lines of the source, not of its copy. Shaders of lab/ have no copy.
# $(1) the result without .spv (% for any), $(2) its source, $(3) macros or nothing
define shader_rule
$(MADE)/gen/$(1).spv: $(if $(filter lab/%,$(2)),,$(MADE)/gen/glsl/)$(patsubst shaders/%,%,$(2)) | $(MADE)/gen/glsl.stamp
	@mkdir -p $$(@D)
	@echo "  GLSL    $(if $(findstring %,$(1)),$(dir $(2))$$(<F),$(2))"
	$$(V)compile="glslangValidator --quiet -V $(SPIRV_TARGET) $(addprefix -D,$(subst +, ,$(3)))"; \
	    $$$$compile -I$(MADE)/gen/glsl -I$(MADE)/gen --depfile $$(@:.spv=.d) -o $$@ $$< > $$@.log || \
	    { $$$$compile -Ishaders -I$(MADE)/gen -o $$@ $(dir $(2))$$(<F) && cat $$@.log; exit 1; }; rm -f $$@.log
	$$(V)sed -n 's/^[^:]*: *//p' $$(@:.spv=.d) | tr -s ' ' '\n' | \
	    sed '1d; /./s/$$$$/:/' >> $$(@:.spv=.d)
	$$(V)spirv-val $(SPIRV_TARGET) $$@
endef
$(foreach d,shaders tests/gpu tools/view examples,$(foreach s,$(STAGES),$(eval $(call shader_rule,%_$(s),$(d)/%.$(s)))))
field = $(word $(2),$(subst :, ,$(1)))
$(foreach b,$(PERMUTATIONS),$(eval $(call \
    shader_rule,$(call field,$(b),1),shaders/$(call field,$(b),2),$(call field,$(b),3))))

# whole_vectors: see tools/spirv/whole_vectors.h. Only ray queries need Vulkan 1.1.
$(MADE)/gen/%.opt.spv: $(MADE)/gen/%.spv $(MADE)/tools/whole_vectors
	$(V)spirv-opt --target-env=vulkan1.1 -O --strip-debug $< -o $@
	$(V)$(MADE)/tools/whole_vectors $@ $@
	$(V)spirv-val --target-env $(if $(findstring query,$*),vulkan1.1,vulkan1.0) $@

# Compiled beside the objects of the programs, which wait for what is generated.
WHOLE_VECTORS := $(wildcard tools/spirv/*.[ch])
$(MADE)/tools/whole_vectors: $(WHOLE_VECTORS)
	@mkdir -p $(@D)
	$(V)$(CC) -std=c11 $(WARNINGS) -O2 -Itools $(filter %.c,$(WHOLE_VECTORS)) -o $@

$(MADE)/gen/%.spv.h: $(MADE)/gen/%.opt.spv
	$(V){ echo '/* Made from $*. */'; echo 'static const uint32_t masu_spv_$*[] = {'; \
	    od -An -v -tx4 -w32 $< | sed 's/ \([0-9a-f]*\)/0x\1,/g'; echo '};'; } > $@

# The last permutations of a shader have all that others have, and come first.
PACK_SOURCES := tools/generate/pack_spirv.c src/device/unpack.c src/device/spirv_interface.c
$(MADE)/tools/pack_spirv: $(PACK_SOURCES) src/device/unpack.h src/device/spirv_interface.h
	@mkdir -p $(@D)
	$(V)$(CC) -std=c11 $(WARNINGS) -O2 -Isrc $(PACK_SOURCES) -o $@
# pack_for CLASSES: a word for each permutation, with a - before it where none of the classes has a use for it.
pack_for = $(foreach p,$(PACKED),$(if $(filter $p,$(call left_out,$(1))),-)$p)
$(MADE)/gen/packed.h: $(MADE)/tools/pack_spirv $(MADE)/gen/classes.list $(PACKED:%=$(MADE)/gen/%.opt.spv)
	@echo "  PACK    $@"
	$(V)$< $(MADE)/gen $(call pack_for,$(CLASSES)) > $@

# Changes when CLASSES does.
$(MADE)/gen/classes.list: force
	@$(call keep_text,$(CLASSES))

# For `make sizes` and its test: the object that differs, of each class alone.
$(BUILD)/classes/%/packed.h: $(MADE)/tools/pack_spirv $(PACKED:%=$(MADE)/gen/%.opt.spv)
	@mkdir -p $(@D)
	$(V)$< $(MADE)/gen $(call pack_for,$*) > $@
$(BUILD)/classes/%/shaders.o: src/device/shaders.c $(BUILD)/classes/%/packed.h $(MADE)/gen/permutations.h
	$(V)$(CC) -I$(@D) $(ALL_FLAGS) -fPIC -fvisibility=hidden -c $< -o $@
# Classes that omit the same permutations share one object: that of the first of them, or the library's.
alike = $(firstword $(foreach c,$(ALL_CLASSES),$(if $(call differ,$(call parts_of,$(1)),$(call parts_of,$c)),,$c)))
differ = $(filter-out $(1),$(2))$(filter-out $(2),$(1))
object_like = $(if $(call differ,$(call parts_of,$(1)),$(call parts_of,$(CLASSES))),$(if $(filter-out \
    $(1),$(call alike,$(1))),$(BUILD)/classes/$(call alike,$(1))/shaders.o),$(BUILD)/obj/src/device/shaders.o)
define same_object
$(BUILD)/classes/$(1)/shaders.o: $(2)
	@mkdir -p $$(@D)
	$$(V)cp $$< $$@
endef
$(foreach c,$(ALL_CLASSES),$(if $(call object_like,$c),$(eval $(call same_object,$c,$(call object_like,$c)))))

# The texts, as string literals: line by line, with what C would read otherwise escaped ('?' because
# of trigraphs). Strings this long are beyond what C11 promises and within what gcc and clang take;
# hence the pragmas.
# The headers that these shaders, or the text generated for a scene, include directly or through others. masu-bake
# writes all of these files for each scene, so no other header is in the list.
SCENE_INCLUDES := $(shell awk -v from='$(SCENE_SHADERS) sdf/hand_written.glsl' ' \
    FNR == 1 { name = substr(FILENAME, 9); there[name] = 1 } \
    /^ *.include "/ { split($$0, quoted, "\""); uses[name] = uses[name] " " quoted[2] } \
    END { n = split(from, found); for (i = 1; i <= n; i++) { count = split(uses[found[i]], used); \
        for (k = 1; k <= count; k++) if (there[used[k]] && !seen[used[k]]++) found[++n] = used[k]; \
        print "shaders/" found[i] } }' $(addprefix shaders/,$(SCENE_SHADERS)) $(wildcard shaders/*/*.h shaders/*/*.glsl))
SCENE_TEXTS := $(patsubst shaders/%,$(MADE)/gen/glsl/%,$(sort $(SCENE_INCLUDES))) $(MADE)/gen/bindings.h \
    $(foreach p,$(PUSHES),$(if $(filter $(p).%,$(SCENE_SHADERS)),$(MADE)/gen/push/$(p).h))

$(MADE)/gen/scene_sources.h: $(SCENE_TEXTS) $(MADE)/gen/scene_texts.list
	$(V){ echo '/* Made from $(SCENE_TEXTS). */'; \
	    echo '#pragma GCC diagnostic push'; \
	    echo '#pragma GCC diagnostic ignored "-Woverlength-strings"'; \
	    echo 'static const struct {'; \
	    echo '    const char *name;'; \
	    echo '    const char *text;'; \
	    echo '} masu_scene_sources[] = {'; \
	    for f in $(SCENE_TEXTS); do \
	        name=$${f#$(MADE)/gen/}; name=$${name#glsl/}; lab=; case " $(LAB_SCENE_SHADERS) " in *" $$name "*) lab=1; echo '#ifdef MASU_LAB' ;; esac; \
	        echo "    {\"$$name\","; \
	        sed -e 's/[\\"?]/\\&/g' -e 's/.*/     "&\\n"/' "$$f"; echo '     ""},'; \
	        [ -z "$$lab" ] || echo '#endif'; \
	    done; \
	    echo '};'; \
	    echo '#pragma GCC diagnostic pop'; } > $@

# Changes when a text comes or goes.
$(MADE)/gen/scene_texts.list: force
	@$(call keep_text,$(SCENE_TEXTS))

# The tables of shaders/brdf and the tile of shaders/noise. Objects wait for what is generated, so these
# programs have none; the tables take 5 s, and minutes without -O2.
$(MADE)/tools/make_%: tools/generate/make_%.c $(wildcard shaders/shared/*.h) $(TABLE_HEADERS)
	@mkdir -p $(@D)
	$(V)$(CC) -std=c11 $(WARNINGS) -O2 -ffp-contract=off -Ishaders -Itools -I$(MADE)/gen $< -lm -o $@
$(MADE)/tools/make_smaa_area: tools/generate/smaa_tables.h
$(MADE)/tools/make_split_sum: tools/generate/cosines.inc
$(MADE)/gen/%.table: $(MADE)/tools/make_%
	@mkdir -p $(@D)
	@echo "  TABLE   $@"
	$(V)$< > $@
$(MADE)/gen/split_sum.h $(MADE)/gen/blue_noise.h $(MADE)/gen/smaa_area.h: $(MADE)/gen/%.h: $(MADE)/gen/%.table
	$(V)cmp -s $< $@ || cp $< $@
