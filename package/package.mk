# package.mk: how Masu gets to others: the shared library, make install, manual pages and completion (made of what
# the programs say for --help), and the bundle for who keeps the sources in a tree of their own.

# ---- The shared library --------------------------------------------------------------------------

MAJOR  := $(firstword $(subst ., ,$(VERSION)))
MINOR  := $(word 2,$(subst ., ,$(VERSION)))
SHARED := $(BUILD)/lib/libmasu.so.$(VERSION)

# What is not MASU_API is hidden (FOLDER_FLAGS of src/). A sanitizer's own symbols come with the program.
$(SHARED): $(call objects,$(LIB_SOURCES))
	@mkdir -p $(@D)
	@echo "  LD      $@"
	$(V)$(CC) -shared -Wl,-soname,libmasu.so.$(MAJOR) $(if $(filter release debug,$(config)),-Wl$(comma)-z$(comma)defs) \
	    $(LINK_FLAGS) $^ -lm -o $@
	$(V)ln -sf $(@F) $(@D)/libmasu.so.$(MAJOR)
	$(V)ln -sf libmasu.so.$(MAJOR) $(@D)/libmasu.so

# ---- Manual pages, completion --------------------------------------------------------------------

PROGRAMS    := masu masu-bake masu-sdfc masu-meso
MAN_PAGES   := $(PROGRAMS:%=$(BUILD)/man/%.1)
COMPLETIONS := $(PROGRAMS:%=$(BUILD)/completion/%)
.PHONY: man
man: $(MAN_PAGES) $(COMPLETIONS) ## write build/man and build/completion from the programs' --help texts

$(MAN_PAGES): $(BUILD)/man/%.1: $(BUILD)/bin/% package/man.sh package/help.sh
	@mkdir -p $(@D)
	$(V)package/man.sh $< $(VERSION) > $@
$(COMPLETIONS): $(BUILD)/completion/%: $(BUILD)/bin/% package/completion.sh package/help.sh
	@mkdir -p $(@D)
	$(V)package/completion.sh $< > $@

# ---- The bundle ----------------------------------------------------------------------------------

.PHONY: bundle
bundle: $(BUILD)/lib/libmasu.a ## write build/bundle: sources of the library that build without a shader compiler
	$(V)package/bundle.sh $(BUILD)/bundle $(BUILD)/obj $(MADE)/gen $(LIB_SOURCES)

# Not part of the tests: compilers of several hundred MB.
.PHONY: consumers-cross
consumers-cross: all scenes bundle ## build the bundle for Windows, 64-bit Arm and 32-bit x86; compare results on the last two
	$(call install-packages,$(PACKAGES_cross))
	$(V)tests/consumers/cross.sh $(BUILD)/bundle $(BUILD)/cross $(MADE)/scenes

# ---- Installing ----------------------------------------------------------------------------------

root = $(DESTDIR)$(PREFIX)
DOCUMENTS := README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md LICENSE $(wildcard docs/*.md docs/*.jpg)
# What masu conform takes besides itself. Baking takes minutes and is nobody's surprise: scenes are installed
# that are there.
SMOKE_SCENES := $(sort $(shell sed -n 's/.*"scene": "\([^"]*\)".*/\1/p' suites/smoke.json))
PUBLIC_HEADERS := include/masu.h include/masu_knobs.h include/masu_study.h
# $(1) of package/, as FILE
fill = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@MAJOR@|$(MAJOR)|' -e 's|@MINOR@|$(MINOR)|' \
    $(2) package/$(1) >

.PHONY: install install-lib install-tools install-data install-docs uninstall
install: install-lib install-tools install-data install-docs ## install to DESTDIR/PREFIX, by default /usr/local
install-lib: lib ## install headers, libraries, and files for pkg-config and CMake
	$(V)install -d "$(root)/include" "$(root)/lib/pkgconfig" "$(root)/lib/cmake/masu"
	$(V)install -m 644 $(PUBLIC_HEADERS) "$(root)/include"
	$(V)install -m 644 $(BUILD)/lib/libmasu.a $(SHARED) "$(root)/lib"
	$(V)ln -sf libmasu.so.$(VERSION) "$(root)/lib/libmasu.so.$(MAJOR)"
	$(V)ln -sf libmasu.so.$(MAJOR) "$(root)/lib/libmasu.so"
	$(V)$(call fill,masu.pc.in,-e 's|@LIBRARY@|-lmasu|' -e 's|@PRIVATE@|Libs.private: -lm|') "$(root)/lib/pkgconfig/masu.pc"
	$(V)$(call fill,masu.pc.in,-e 's|@LIBRARY@|-l:libmasu.a -lm|' -e '/@PRIVATE@/d') "$(root)/lib/pkgconfig/masu-static.pc"
	$(V)$(call fill,masu-config.cmake.in) "$(root)/lib/cmake/masu/masu-config.cmake"
	$(V)$(call fill,masu-config-version.cmake.in) "$(root)/lib/cmake/masu/masu-config-version.cmake"
install-tools: tools man ## install masu, masu-bake, masu-sdfc and masu-meso, their manual pages and completion
	$(V)install -d "$(root)/bin" "$(root)/share/man/man1" "$(root)/share/bash-completion/completions"
	$(V)install -m 755 $(PROGRAMS:%=$(BUILD)/bin/%) "$(root)/bin"
	$(V)install -m 644 $(MAN_PAGES) "$(root)/share/man/man1"
	$(V)install -m 644 $(COMPLETIONS) "$(root)/share/bash-completion/completions"
install-data: $(SUITES) ## install the suites of masu conform, and the baked scenes of the suite smoke
	$(V)install -d "$(root)/share/masu/suites"
	$(V)install -m 644 $(SUITES) "$(root)/share/masu/suites"
	$(V)missing=; for s in $(SMOKE_SCENES); do \
	    if [ -f $(MADE)/scenes/$$s.masu ]; then install -d "$(root)/share/masu/scenes" && \
	        install -m 644 $(MADE)/scenes/$$s.masu "$(root)/share/masu/scenes" || exit 1; \
	    else missing="$$missing $$s"; fi; \
	done; [ -z "$$missing" ] || \
	    echo "masu: not baked, so not installed:$$missing; 'make scenes install' gives masu conform its scenes"
install-docs: ## install licence and documents to share/doc/masu
	$(V)install -d "$(root)/share/doc/masu/docs"
	$(V)install -m 644 $(filter-out docs/%,$(DOCUMENTS)) "$(root)/share/doc/masu"
	$(V)install -m 644 $(filter docs/%,$(DOCUMENTS)) "$(root)/share/doc/masu/docs"
uninstall: ## remove all installed files
	$(V)cd "$(root)" && rm -f $(PUBLIC_HEADERS) $(addprefix lib/,libmasu.a libmasu.so libmasu.so.$(MAJOR) libmasu.so.$(VERSION))
	$(V)cd "$(root)" && rm -f lib/pkgconfig/masu.pc lib/pkgconfig/masu-static.pc $(PROGRAMS:%=bin/%)
	$(V)cd "$(root)" && rm -f $(PROGRAMS:%=share/man/man1/%.1) $(PROGRAMS:%=share/bash-completion/completions/%)
	$(V)cd "$(root)" && rm -f $(SUITES:$(BUILD)/%=share/masu/%) $(SMOKE_SCENES:%=share/masu/scenes/%.masu)
	$(V)cd "$(root)" && rm -rf lib/cmake/masu share/doc/masu
	$(V)cd "$(root)" && rmdir share/masu/scenes share/masu/suites share/masu 2> /dev/null || true
