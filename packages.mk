# packages.mk: the one list of Debian packages that Masu uses, by role, and how they get here. Names
# are those of Debian 12.
#
# `make demo` installs build + demo, `make check` build + demo + test, `make check FULL=1` also
# full: each only what is missing. make itself is not listed: it is what reads this.

# to build the library and the programs
PACKAGES_build := gcc libc6-dev libvulkan-dev
PACKAGES_build += glslang-tools spirv-tools
PACKAGES_build += libassimp-dev libjansson-dev libstb-dev libmagickwand-dev pkgconf libmeshoptimizer-dev
PACKAGES_build += libembree-dev libdraco-dev g++

# to bake and render the demo: a Vulkan driver for any processor, and the models that scenes/ places
PACKAGES_demo := libvulkan1 mesa-vulkan-drivers assimp-testmodels

# to bake the world forza: the data of TORCS
PACKAGES_worlds := torcs-data

# to build masu-view: the window, the user interface, and the font that becomes part of the program. Without, `make`
# leaves it out
PACKAGES_view := libsdl2-dev libimgui-dev g++ fonts-dejavu-core

# to run the tests; g++, cmake, and pkgconf from above, look at what is installed as a user of theirs would;
# ImageMagick measures pictures beside us; masu-view has a screen of Xvfb; LuaJIT reads the generated declarations
PACKAGES_test := libcmocka-dev vulkan-validationlayers g++ imagemagick cmake $(PACKAGES_view) xvfb luajit

# to build everything a second time with the other compiler and its sanitizers, whose library is a package of
# its own (make check FULL=1), and for `make fuzz`; and another measure of SSIM
PACKAGES_full := clang libclang-rt-dev python3-skimage

# for the plots of masu bench and masu-lab, which go without. Never installed by itself
PACKAGES_plots := gnuplot-nox

# for `masu-lab reference` of scenes with hand-written GLSL, which becomes C++ (make lab-check)
PACKAGES_lab := spirv-cross libglm-dev g++

# to build the drivers of `masu-lab isa` for Intel and Adreno (make isa-drivers)
PACKAGES_isa := meson ninja-build bison flex python3-mako python3-yaml libdrm-dev libexpat1-dev libelf-dev zlib1g-dev libncurses-dev
PACKAGES_isa += pkgconf g++ glslang-tools curl ca-certificates

# for `make reference-blender`
PACKAGES_blender := blender python3-numpy

# to build the library for other machines and run a part of it there (make consumers-cross). Never installed by itself
PACKAGES_cross := gcc-mingw-w64-x86-64 gcc-aarch64-linux-gnu libc6-dev-arm64-cross
PACKAGES_cross += gcc-i686-linux-gnu libc6-dev-i386-cross qemu-user

# for `make analyse`. Never installed by itself
PACKAGES_analyse := gcc clang-tidy cppcheck

# for `make reference` and `make deb`. Never installed by itself
PACKAGES_reference := doxygen
PACKAGES_deb := dpkg-dev fakeroot

# for who works on Masu: `make format`, `make compdb`. Never installed by itself
PACKAGES_dev := clang-format bear

# Installs those of $(1) that dpkg does not call installed. None missing: nothing done, no network.
define install-packages
@command -v dpkg-query > /dev/null || { \
    echo "masu: no dpkg here; these Debian packages or their like are needed: $(1)"; exit 0; }; \
have=$$(dpkg-query -W -f='$${Package} $${db:Status-Status}\n' $(1) 2> /dev/null | \
    sed -n 's/ installed$$//p'); \
missing=; for p in $(1); do echo "$$have" | grep -qx -e "$$p" || missing="$$missing $$p"; done; \
[ "$$missing" ] || exit 0; \
sudo=; [ "$$(id -u)" = 0 ] || sudo=sudo; \
if [ "$$sudo" ] && ! command -v sudo > /dev/null; then \
    echo "masu: packages are missing; as root: apt-get install$$missing" >&2; exit 1; \
fi; \
echo "masu: installing$$missing"; \
apt="$$sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300"; \
apt="$$apt -o Dpkg::Use-Pty=0 --no-install-recommends"; \
$$apt update && $$apt install -y $$missing > /dev/null || { \
    echo "masu: apt-get could not install:$$missing" >&2; exit 1; }
endef

.PHONY: packages deps-build deps-demo deps-worlds deps-view deps-test deps-analyse
packages: ## print the Debian packages by role
	@$(foreach role,build demo worlds view test full lab plots isa cross analyse reference deb dev,echo "$(role): $(PACKAGES_$(role))";)
deps-build: ## install the packages that building needs
	$(call install-packages,$(PACKAGES_build))
deps-demo: ## install the packages that the demo needs
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_demo))
deps-worlds: ## install the packages that the worlds need
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_worlds))
deps-view: ## install the packages that masu-view needs
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_view))
deps-test: ## install the packages that the tests need
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_demo) $(PACKAGES_test) \
	    $(if $(FULL),$(PACKAGES_full)))
deps-analyse: ## install the packages that make analyse needs
	$(call install-packages,$(PACKAGES_build) $(PACKAGES_analyse))
