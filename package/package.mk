# package.mk: how Masu gets to others: the shared library, make install, manual pages and completion (made of what
# the programs say for --help), and the bundle for who keeps the sources in a tree of their own.

# ---- The shared library --------------------------------------------------------------------------

MAJOR  := $(firstword $(subst ., ,$(VERSION)))
MINOR  := $(word 2,$(subst ., ,$(VERSION)))
# Until 1.0 a minor version may break binary compatibility, so it is part of the soname.
ABI    := $(if $(filter 0,$(MAJOR)),0.$(MINOR),$(MAJOR))
SHARED := $(BUILD)/lib/libmasu.so.$(VERSION)

# What is not MASU_API is hidden (FOLDER_FLAGS of src/). A sanitizer's own symbols come with the program.
$(SHARED): $(call objects,$(LIB_SOURCES))
	@mkdir -p $(@D)
	@echo "  LD      $@"
	$(V)$(CC) -shared -Wl,-soname,libmasu.so.$(ABI) $(if $(filter release debug,$(config)),-Wl$(comma)-z$(comma)defs) \
	    $(LINK_FLAGS) $^ -lm -o $@
	$(V)ln -sf $(@F) $(@D)/libmasu.so.$(ABI)
	$(V)ln -sf libmasu.so.$(ABI) $(@D)/libmasu.so

# ---- Manual pages, completion --------------------------------------------------------------------

PROGRAMS    := masu masu-bake masu-sdfc masu-meso $(if $(HAVE_VIEW),masu-view)
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

# ---- The interface -------------------------------------------------------------------------------

# The declarations without preprocessor, for generators of bindings.
CDEF := $(BUILD)/masu.cdef
$(CDEF): package/cdef.sh $(wildcard include/*.h)
	$(V)CC='$(CC)' package/cdef.sh > $@

.PHONY: abi reference
abi: ## write tests/consumers/abi.txt (layouts, functions); refuses what breaks a released ABI
	$(V)CC='$(CC)' tests/scripts/abi.sh --write
# Warnings are errors.
reference: ## write build/reference/index.html from the public headers (with Doxygen)
	$(call install-packages,$(PACKAGES_reference))
	$(V)mkdir -p $(BUILD)
	$(V){ cat package/Doxyfile; echo 'OUTPUT_DIRECTORY = $(BUILD)'; echo 'PROJECT_NUMBER = $(VERSION)'; } | doxygen -
	@echo "The reference is $(abspath $(BUILD)/reference/index.html)"

# Not part of the tests: compilers of several hundred MB.
.PHONY: consumers-cross
consumers-cross: all scenes bundle ## build the bundle for Windows, 64-bit Arm and 32-bit x86; compare results on the last two
	$(call install-packages,$(PACKAGES_cross))
	$(V)tests/consumers/cross.sh $(BUILD)/bundle $(BUILD)/cross $(MADE)/scenes

# ---- Installing ----------------------------------------------------------------------------------

root = $(DESTDIR)$(PREFIX)
DOCUMENTS := README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md LICENSE $(wildcard docs/*.md docs/*.jpg docs/design/*.md)
DOCUMENTS += docs/report/ladders.txt
# The examples with what they are compiled from, next to the documents that link to them.
EXAMPLE_FILES := $(wildcard examples/*.[ch] examples/*.cpp examples/*.lua examples/*.frag examples/*.vert examples/shared/*.[ch] examples/drive/*.[ch])
EXAMPLE_HOST  := $(foreach f,atomic_file file_kind headless headless_image image image_parts image_write exr,$(wildcard platform/$(f).[ch]))
EXAMPLE_SPIRV := $(MADE)/gen/host_pass_frag.spv.h $(MADE)/gen/host_pass_vert.spv.h
# What masu conform takes besides itself. Baking takes minutes and is nobody's surprise: scenes are installed
# that are there.
SMOKE_SCENES := $(sort $(shell sed -n 's/.*"scene": "\([^"]*\)".*/\1/p' suites/smoke.json))
PUBLIC_HEADERS := include/masu.h include/masu_knobs.h include/masu_study.h include/masu.hpp
# $(1) of package/, as FILE
fill = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@MAJOR@|$(MAJOR)|' -e 's|@MINOR@|$(MINOR)|' -e 's|@ABI@|$(ABI)|' \
    $(2) package/$(1) >

.PHONY: install install-lib install-tools install-data install-docs install-examples uninstall
install: install-lib install-tools install-data install-docs install-examples ## install to DESTDIR/PREFIX, by default /usr/local
# Folders that others use too. Those that are not there yet are noted, for uninstall.
SHARED_FOLDERS := . bin include lib lib/pkgconfig lib/cmake share share/doc share/man share/man/man1 \
    share/bash-completion share/bash-completion/completions
MADE_FOLDERS   := share/doc/masu/folders
.PHONY: install-folders
install-folders:
	$(V)made=; for f in $(SHARED_FOLDERS); do [ -d "$(root)/$$f" ] || made="$$made $$f"; done; \
	    install -d "$(root)/share/doc/masu" && for f in $$made; do echo $$f >> "$(root)/$(MADE_FOLDERS)"; done
install-lib: lib $(CDEF) install-folders ## install headers, libraries, and files for pkg-config and CMake
	$(V)install -d "$(root)/include" "$(root)/lib/pkgconfig" "$(root)/lib/cmake/masu"
	$(V)install -m 644 $(PUBLIC_HEADERS) "$(root)/include"
	$(V)install -d "$(root)/share/masu"
	$(V)install -m 644 $(CDEF) "$(root)/share/masu"
	$(V)install -m 644 $(BUILD)/lib/libmasu.a $(SHARED) "$(root)/lib"
	$(V)ln -sf libmasu.so.$(VERSION) "$(root)/lib/libmasu.so.$(ABI)"
	$(V)ln -sf libmasu.so.$(ABI) "$(root)/lib/libmasu.so"
	$(V)$(call fill,masu.pc.in,-e 's|@LIBRARY@|-lmasu|' -e 's|@PRIVATE@|Libs.private: -lm|') "$(root)/lib/pkgconfig/masu.pc"
	$(V)$(call fill,masu.pc.in,-e 's|@LIBRARY@|-l:libmasu.a -lm|' -e '/@PRIVATE@/d') "$(root)/lib/pkgconfig/masu-static.pc"
	$(V)$(call fill,masu-config.cmake.in) "$(root)/lib/cmake/masu/masu-config.cmake"
	$(V)$(call fill,masu-config-version.cmake.in) "$(root)/lib/cmake/masu/masu-config-version.cmake"
install-tools: tools man install-folders ## install masu, masu-bake, masu-sdfc, masu-meso and masu-view (with SDL2, Dear ImGui), their manual pages and completion
	$(V)install -d "$(root)/bin" "$(root)/share/man/man1" "$(root)/share/bash-completion/completions"
	$(V)install -m 755 $(PROGRAMS:%=$(BUILD)/bin/%) "$(root)/bin"
	$(V)install -m 644 $(MAN_PAGES) "$(root)/share/man/man1"
	$(V)install -m 644 $(COMPLETIONS) "$(root)/share/bash-completion/completions"
install-data: $(SUITES) install-folders ## install the suites of masu conform, and the baked scenes of the suite smoke
	$(V)install -d "$(root)/share/masu/suites"
	$(V)install -m 644 $(SUITES) "$(root)/share/masu/suites"
	$(V)missing=; for s in $(SMOKE_SCENES); do \
	    if [ -f $(MADE)/scenes/$$s.masu ]; then install -d "$(root)/share/masu/scenes" && \
	        install -m 644 $(MADE)/scenes/$$s.masu "$(root)/share/masu/scenes" || exit 1; \
	    else missing="$$missing $$s"; fi; \
	done; [ -z "$$missing" ] || \
	    echo "masu: not baked, so not installed:$$missing; 'make scenes install' gives masu conform its scenes"
install-docs: install-folders ## install licence and documents to share/doc/masu
	$(V)for f in $(DOCUMENTS); do \
	    install -d "$(root)/share/doc/masu/$$(dirname $$f)" && install -m 644 $$f "$(root)/share/doc/masu/$$f" || exit 1; \
	    case $$f in *.md) package/docs.sh $$f $(DOCUMENTS) $(EXAMPLE_FILES) > "$(root)/share/doc/masu/$$f" || exit 1;; esac; \
	done
install-examples: $(EXAMPLE_SPIRV) install-folders ## install the examples and what they are compiled from to share/doc/masu/examples
	$(V)for f in $(EXAMPLE_FILES); do \
	    install -d "$(root)/share/doc/masu/$$(dirname $$f)" && install -m 644 $$f "$(root)/share/doc/masu/$$f" || exit 1; \
	done
	$(V)install -d "$(root)/share/doc/masu/examples/platform"
	$(V)install -m 644 $(EXAMPLE_HOST) "$(root)/share/doc/masu/examples/platform"
	$(V)install -m 644 $(EXAMPLE_SPIRV) "$(root)/share/doc/masu/examples"
	$(V)install -m 644 package/examples-Makefile "$(root)/share/doc/masu/examples/Makefile"
.PHONY: deb
deb: ## write build/masu_VERSION_ARCH.deb: library, programs, documents and examples for Debian and Ubuntu
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_view) $(PACKAGES_deb))
	+$(V)$(more) all man
	$(V)rm -rf $(BUILD)/deb
	+$(V)$(MAKE) --no-print-directory install DESTDIR=$(abspath $(BUILD))/deb PREFIX=/usr
	$(V)package/deb.sh $(VERSION) $(BUILD)/deb $(BUILD)

INSTALLED_PROGRAMS := $(PROGRAMS) $(if $(HAVE_VIEW),,masu-view)
uninstall: ## remove all installed files, and the folders that install has made
	$(V)cd "$(root)" && rm -f $(PUBLIC_HEADERS) $(addprefix lib/,libmasu.a libmasu.so libmasu.so.$(ABI) libmasu.so.$(VERSION))
	$(V)cd "$(root)" && rm -f lib/pkgconfig/masu.pc lib/pkgconfig/masu-static.pc $(INSTALLED_PROGRAMS:%=bin/%)
	$(V)cd "$(root)" && rm -f $(INSTALLED_PROGRAMS:%=share/man/man1/%.1) \
	    $(INSTALLED_PROGRAMS:%=share/bash-completion/completions/%)
	$(V)cd "$(root)" && rm -f share/masu/masu.cdef $(SUITES:$(BUILD)/%=share/masu/%) $(SMOKE_SCENES:%=share/masu/scenes/%.masu)
	$(V)cd "$(root)" && here=$$(pwd) && made=$$(sort -r $(MADE_FOLDERS) 2> /dev/null || true) && rm -rf lib/cmake/masu share/doc/masu && \
	    for f in share/masu/scenes share/masu/suites share/masu $$made; do \
	        [ "$$f" != . ] || f=; rmdir "$$here/$$f" 2> /dev/null || true; \
	    done
