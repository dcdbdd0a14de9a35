# platform.mk: parts of a host (headless Vulkan host, PNG, clock), for the programs and the tests.
# Not installed.

$(BUILD)/lib/libmasu-platform.a: $(call objects,$(wildcard platform/*.c))

# stb's JPEG writer shifts bits out of signed integers.
$(BUILD)/obj/platform/image_write.o: FOLDER_FLAGS += -fno-sanitize=shift
