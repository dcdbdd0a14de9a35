# shaders.mk: GLSL to SPIR-V to C.
#
#   shaders/NAME.STAGE -> gen/NAME_STAGE.spv      with debug names: tests read struct offsets there
#                      -> gen/NAME_STAGE.opt.spv  optimised and stripped
#                      -> gen/NAME_STAGE.spv.h    that, as `const uint32_t masu_spv_NAME_STAGE[]`
#
# Both SPIR-V files pass spirv-val. Shaders of tests/gpu are compiled the same way. A scene shader
# is not complete without the GLSL of a scene: masu-bake compiles it, so it and all that it may
# include are embedded as text instead.

SCENE_SHADERS := update.comp classify.comp cone.comp march.comp march_plain.comp march_seed.comp \
    march_checkerboard.comp march_fragment.frag sdf_velocity.comp sdf_occlusion.comp \
    specular_trace_sdf.comp

SPIRV_TARGET := --target-env vulkan1.1
STAGES       := comp vert frag

SHADERS := $(filter-out $(SCENE_SHADERS:%=shaders/%),$(wildcard $(STAGES:%=shaders/*.%)))
SHADERS += $(wildcard $(STAGES:%=tests/gpu/*.%))

# A shader compiled a second time with macros: NAME_STAGE of the second build, its file, the macros
# with + between.
SECOND_BUILDS := gbuffer_velocity_vert:gbuffer.vert:MASU_MOTION
SECOND_BUILDS += gbuffer_velocity_frag:gbuffer.frag:MASU_MOTION
SECOND_BUILDS += gbuffer_surface_frag:gbuffer.frag:MASU_SURFACE
SECOND_BUILDS += gbuffer_velocity_surface_frag:gbuffer.frag:MASU_MOTION+MASU_SURFACE
SECOND_BUILDS += gbuffer_textured_surface_frag:gbuffer.frag:MASU_TEXTURES+MASU_SURFACE
SECOND_BUILDS += gbuffer_textured_velocity_surface_frag:gbuffer.frag:MASU_TEXTURES+MASU_MOTION+MASU_SURFACE
SECOND_BUILDS += tonemap_deep_comp:tonemap.comp:MASU_DEEP
SECOND_BUILDS += tonemap_metered_comp:tonemap.comp:MASU_METERED
SECOND_BUILDS += tonemap_deep_metered_comp:tonemap.comp:MASU_DEEP+MASU_METERED
SECOND_BUILDS += light_surface_comp:light.comp:MASU_SURFACE
SECOND_BUILDS += light_probes_comp:light.comp:MASU_PROBES
SECOND_BUILDS += light_probes_surface_comp:light.comp:MASU_PROBES+MASU_SURFACE
SECOND_BUILDS += light_lights_comp:light.comp:MASU_LIGHTS
SECOND_BUILDS += light_lights_surface_comp:light.comp:MASU_LIGHTS+MASU_SURFACE
SECOND_BUILDS += light_lights_probes_comp:light.comp:MASU_LIGHTS+MASU_PROBES
SECOND_BUILDS += light_lights_probes_surface_comp:light.comp:MASU_LIGHTS+MASU_PROBES+MASU_SURFACE
SECOND_BUILDS += light_occluded_comp:light.comp:MASU_OCCLUSION
SECOND_BUILDS += light_occluded_surface_comp:light.comp:MASU_OCCLUSION+MASU_SURFACE
SECOND_BUILDS += light_occluded_probes_comp:light.comp:MASU_OCCLUSION+MASU_PROBES
SECOND_BUILDS += light_occluded_probes_surface_comp:light.comp:MASU_OCCLUSION+MASU_PROBES+MASU_SURFACE
SECOND_BUILDS += light_occluded_lights_comp:light.comp:MASU_OCCLUSION+MASU_LIGHTS
SECOND_BUILDS += light_occluded_lights_surface_comp:light.comp:MASU_OCCLUSION+MASU_LIGHTS+MASU_SURFACE
SECOND_BUILDS += light_occluded_lights_probes_comp:light.comp:MASU_OCCLUSION+MASU_LIGHTS+MASU_PROBES
SECOND_BUILDS += light_occluded_lights_probes_surface_comp:light.comp:MASU_OCCLUSION+MASU_LIGHTS+MASU_PROBES+MASU_SURFACE
SECOND_BUILDS += transparents_textured_vert:transparents.vert:MASU_TEXTURES
SECOND_BUILDS += transparents_textured_frag:transparents.frag:MASU_TEXTURES
SECOND_BUILDS += transparents_sun_frag:transparents.frag:MASU_SUN_MAP
SECOND_BUILDS += transparents_textured_sun_frag:transparents.frag:MASU_TEXTURES+MASU_SUN_MAP
SECOND_BUILDS += cascade_masked_vert:cascade.vert:MASU_TEXTURES
SECOND_BUILDS += gbuffer_textured_vert:gbuffer.vert:MASU_TEXTURES
SECOND_BUILDS += gbuffer_textured_frag:gbuffer.frag:MASU_TEXTURES
SECOND_BUILDS += gbuffer_textured_velocity_vert:gbuffer.vert:MASU_TEXTURES+MASU_MOTION
SECOND_BUILDS += gbuffer_textured_velocity_frag:gbuffer.frag:MASU_TEXTURES+MASU_MOTION

SECOND_BUILDS += specular_guide_surface_comp:specular_guide.comp:MASU_SURFACE
SECOND_BUILDS += specular_query_masks_comp:specular_query.comp:MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_rays_surface_comp:specular_rays.comp:MASU_SURFACE
SECOND_BUILDS += specular_composite_surface_comp:specular_composite.comp:MASU_SURFACE
SECOND_BUILDS += specular_composite_fine_comp:specular_composite.comp:MASU_FINE
SECOND_BUILDS += specular_composite_fine_surface_comp:specular_composite.comp:MASU_FINE+MASU_SURFACE
SECOND_BUILDS += specular_keep_steady_comp:specular_keep.comp:MASU_STEADY
SECOND_BUILDS += specular_shade_sun_comp:specular_shade.comp:MASU_SUN_MAP
SECOND_BUILDS += specular_shade_lights_comp:specular_shade.comp:MASU_LIGHTS
SECOND_BUILDS += specular_shade_lights_sun_comp:specular_shade.comp:MASU_LIGHTS+MASU_SUN_MAP
SECOND_BUILDS += specular_shade_probes_comp:specular_shade.comp:MASU_PROBES
SECOND_BUILDS += specular_shade_probes_sun_comp:specular_shade.comp:MASU_PROBES+MASU_SUN_MAP
SECOND_BUILDS += specular_shade_lights_probes_comp:specular_shade.comp:MASU_LIGHTS+MASU_PROBES
SECOND_BUILDS += specular_shade_lights_probes_sun_comp:specular_shade.comp:MASU_LIGHTS+MASU_PROBES+MASU_SUN_MAP
SECOND_BUILDS += specular_trace_masks_comp:specular_trace.comp:MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_comp:specular_shade.comp:MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_sun_comp:specular_shade.comp:MASU_SUN_MAP+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_lights_comp:specular_shade.comp:MASU_LIGHTS+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_lights_sun_comp:specular_shade.comp:MASU_LIGHTS+MASU_SUN_MAP+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_probes_comp:specular_shade.comp:MASU_PROBES+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_probes_sun_comp:specular_shade.comp:MASU_PROBES+MASU_SUN_MAP+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_lights_probes_comp:specular_shade.comp:MASU_LIGHTS+MASU_PROBES+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_textures_lights_probes_sun_comp:specular_shade.comp:MASU_LIGHTS+MASU_PROBES+MASU_SUN_MAP+MASU_TRACE_TEXTURES
SECOND_BUILDS += specular_shade_sdf_comp:specular_shade.comp:MASU_NO_POLYGONS
SECOND_BUILDS += specular_shade_sdf_sun_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_SUN_MAP
SECOND_BUILDS += specular_shade_sdf_lights_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_LIGHTS
SECOND_BUILDS += specular_shade_sdf_lights_sun_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_LIGHTS+MASU_SUN_MAP
SECOND_BUILDS += specular_shade_sdf_probes_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_PROBES
SECOND_BUILDS += specular_shade_sdf_probes_sun_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_PROBES+MASU_SUN_MAP
SECOND_BUILDS += specular_shade_sdf_lights_probes_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_LIGHTS+MASU_PROBES
SECOND_BUILDS += specular_shade_sdf_lights_probes_sun_comp:specular_shade.comp:MASU_NO_POLYGONS+MASU_LIGHTS+MASU_PROBES+MASU_SUN_MAP
SECOND_BUILDS += easu_bytes_comp:easu.comp:MASU_BYTES
SECOND_BUILDS += easu_scene_comp:easu.comp:MASU_BYTES+MASU_OUTPUT
SECOND_BUILDS += easu_deep_comp:easu.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += rcas_scene_comp:rcas.comp:MASU_BYTES+MASU_OUTPUT
SECOND_BUILDS += rcas_deep_comp:rcas.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += fsr1_scene_comp:fsr1.comp:MASU_BYTES+MASU_OUTPUT
SECOND_BUILDS += easu_fast_bytes_comp:easu_fast.comp:MASU_BYTES
SECOND_BUILDS += easu_fast_counted_comp:easu_fast.comp:MASU_COUNTED
SECOND_BUILDS += easu_fast_bytes_counted_comp:easu_fast.comp:MASU_BYTES+MASU_COUNTED
SECOND_BUILDS += easu_fast_scene_comp:easu_fast.comp:MASU_BYTES+MASU_OUTPUT
SECOND_BUILDS += easu_fast_deep_comp:easu_fast.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += easu_fast_scene_counted_comp:easu_fast.comp:MASU_BYTES+MASU_OUTPUT+MASU_COUNTED
SECOND_BUILDS += easu_fast_deep_counted_comp:easu_fast.comp:MASU_OUTPUT+MASU_DEEP+MASU_COUNTED
SECOND_BUILDS += easu_fast_half_comp:easu_fast.comp:MASU_HALF
SECOND_BUILDS += easu_fast_bytes_half_comp:easu_fast.comp:MASU_BYTES+MASU_HALF
SECOND_BUILDS += easu_fast_scene_half_comp:easu_fast.comp:MASU_BYTES+MASU_OUTPUT+MASU_HALF
SECOND_BUILDS += easu_fast_deep_half_comp:easu_fast.comp:MASU_OUTPUT+MASU_DEEP+MASU_HALF
SECOND_BUILDS += easu_fast_scene_half_counted_comp:easu_fast.comp:MASU_BYTES+MASU_OUTPUT+MASU_HALF+MASU_COUNTED
SECOND_BUILDS += easu_fast_deep_half_counted_comp:easu_fast.comp:MASU_OUTPUT+MASU_DEEP+MASU_HALF+MASU_COUNTED
SECOND_BUILDS += bilinear_scene_comp:bilinear.comp:MASU_OUTPUT
SECOND_BUILDS += bilinear_deep_comp:bilinear.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += fxaa_scene_comp:fxaa.comp:MASU_OUTPUT
SECOND_BUILDS += fxaa_deep_comp:fxaa.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += smaa_edges_scene_comp:smaa_edges.comp:MASU_OUTPUT
SECOND_BUILDS += smaa_edges_deep_comp:smaa_edges.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += smaa_blend_scene_comp:smaa_blend.comp:MASU_OUTPUT
SECOND_BUILDS += smaa_blend_deep_comp:smaa_blend.comp:MASU_OUTPUT+MASU_DEEP
SECOND_BUILDS += fsr1_bytes_comp:fsr1.comp:MASU_BYTES
SECOND_BUILDS += rcas_bytes_comp:rcas.comp:MASU_BYTES
SECOND_BUILDS += trace_rays_counted_comp:trace_rays.comp:MASU_TRACE_COUNTERS

# dir/NAME.STAGE is NAME_STAGE
SPIRV_HEADERS := $(foreach s,$(notdir $(SHADERS)),$(BUILD)/gen/$(subst .,_,$(s)).spv.h)
SPIRV_HEADERS += $(foreach b,$(SECOND_BUILDS),$(BUILD)/gen/$(firstword $(subst :, ,$(b))).spv.h)
GENERATED     := $(SPIRV_HEADERS) $(BUILD)/gen/scene_sources.h $(BUILD)/gen/split_sum.h $(BUILD)/gen/blue_noise.h $(BUILD)/gen/smaa_area.h

# glslang's dependency file has no empty rules for what is included; without them, the next make
# would fail after a file is removed.
# $(1) the result without .spv (% for any), $(2) its source, $(3) macros or nothing
define shader_rule
$(BUILD)/gen/$(1).spv: $(2)
	@mkdir -p $$(@D)
	@echo "  GLSL    $$<"
	$$(V)glslangValidator --quiet -V $(SPIRV_TARGET) $(addprefix -D,$(subst +, ,$(3))) -Ishaders \
	    --depfile $$(@:.spv=.d) -o $$@ $$<
	$$(V)sed -n 's/^[^:]*: *//p' $$(@:.spv=.d) | tr -s ' ' '\n' | \
	    sed '1d; /./s/$$$$/:/' >> $$(@:.spv=.d)
	$$(V)spirv-val $(SPIRV_TARGET) $$@
endef
$(foreach d,shaders tests/gpu,$(foreach s,$(STAGES),$(eval $(call shader_rule,%_$(s),$(d)/%.$(s)))))
field = $(word $(2),$(subst :, ,$(1)))
$(foreach b,$(SECOND_BUILDS),$(eval $(call \
    shader_rule,$(call field,$(b),1),shaders/$(call field,$(b),2),$(call field,$(b),3))))

$(BUILD)/gen/%.opt.spv: $(BUILD)/gen/%.spv
	$(V)spirv-opt --target-env=vulkan1.1 -O --strip-debug $< -o $@
	$(V)spirv-val $(SPIRV_TARGET) $@

$(BUILD)/gen/%.spv.h: $(BUILD)/gen/%.opt.spv
	$(V){ echo '/* Made from $*. */'; echo 'static const uint32_t masu_spv_$*[] = {'; \
	    od -An -v -tx4 -w32 $< | sed 's/ \([0-9a-f]*\)/0x\1,/g'; echo '};'; } > $@

# The texts, as string literals: line by line, with what C would read otherwise escaped ('?' because
# of trigraphs). Strings this long are beyond what C11 promises and within what gcc and clang take;
# hence the pragmas.
SCENE_TEXTS := $(wildcard $(addprefix shaders/,$(SCENE_SHADERS)) shaders/*/*.h shaders/*/*.glsl)

$(BUILD)/gen/scene_sources.h: $(SCENE_TEXTS) $(BUILD)/gen/scene_texts.list
	$(V){ echo '/* Made from $(SCENE_TEXTS). */'; \
	    echo '#pragma GCC diagnostic push'; \
	    echo '#pragma GCC diagnostic ignored "-Woverlength-strings"'; \
	    echo 'static const struct {'; \
	    echo '    const char *name;'; \
	    echo '    const char *text;'; \
	    echo '} masu_scene_sources[] = {'; \
	    for f in $(SCENE_TEXTS); do \
	        echo "    {\"$${f#shaders/}\","; \
	        sed -e 's/[\\"?]/\\&/g' -e 's/.*/     "&\\n"/' "$$f"; echo '     ""},'; \
	    done; \
	    echo '};'; \
	    echo '#pragma GCC diagnostic pop'; } > $@

# Changes when a text comes or goes.
$(BUILD)/gen/scene_texts.list: force
	@mkdir -p $(@D)
	@echo '$(SCENE_TEXTS)' | cmp -s - $@ || echo '$(SCENE_TEXTS)' > $@

# The tables of shaders/brdf and the tile of shaders/noise. Objects wait for what is generated, so these
# programs have none; the tables take 5 s, and minutes without -O2.
$(BUILD)/tools/make_%: tools/generate/make_%.c shaders/shared/masu_shared.h
	@mkdir -p $(@D)
	$(V)$(CC) -std=c11 $(WARNINGS) -O2 -ffp-contract=off -Ishaders -Itools $< -lm -o $@
$(BUILD)/tools/make_smaa_area: tools/generate/smaa_tables.h
$(BUILD)/gen/split_sum.h $(BUILD)/gen/blue_noise.h $(BUILD)/gen/smaa_area.h: $(BUILD)/gen/%.h: $(BUILD)/tools/make_%
	@mkdir -p $(@D)
	@echo "  TABLE   $@"
	$(V)$< > $@
