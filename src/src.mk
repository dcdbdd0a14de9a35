# src.mk: the runtime library. Vulkan headers and libc only; nothing of Vulkan is linked.

LIB_SOURCES := $(wildcard src/*.c src/*/*.c)

# The version stands once, in the header.
VERSION := $(shell sed -n 's/^.define MASU_VERSION_[A-Z]* //p' include/masu.h | paste -sd.)

$(BUILD)/lib/libmasu.a: $(call objects,$(LIB_SOURCES))
