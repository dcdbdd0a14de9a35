// raii.cpp SCENE.masu OUT.png: minimal.c in C++, with include/masu.hpp: objects release
// their resources, errors are exceptions. platform/headless.h provides the device and the image.
#include "masu.hpp"

extern "C" {
#include "headless.h"
#include "image.h"
}

#include <cstdio>
#include <fstream>
#include <iterator>

// The host's device and one image.
struct host {
    masu_headless device{};
    masu_headless_target image{};
    char error[512] = "";

    host(uint32_t width, uint32_t height) {
        masu_headless_desc desc{};
        desc.validate = true;
        check(masu_headless_open(&desc, &device, error, sizeof error));
        check(masu_headless_target_create(&device, width, height, VK_FORMAT_R8G8B8A8_UNORM, true, &image, error,
                                          sizeof error));
    }
    ~host() {
        masu_headless_target_destroy(&device, &image);
        masu_headless_close(&device);
    }
    host(const host &) = delete;
    void check(bool good) const {
        if (!good) throw std::runtime_error(error);
    }
    void run(const masu_commands &c) { check(masu_headless_run(&device, c.buffer, error, sizeof error)); }
    void save(const char *path) {
        check(masu_headless_target_read(&device, &image, error, sizeof error));
        check(masu_image_save_png(path, image.mapped, image.width, image.height, 0, error, sizeof error));
    }
};

static int render(const char *scene_path, const char *image_path) {
    std::ifstream file(scene_path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    masu::scene scene(bytes.data(), bytes.size());
    host h(320, 180);

    masu::desc desc;
    desc.vulkan.get_instance_proc_addr = vkGetInstanceProcAddr;
    desc.vulkan.instance = h.device.instance;
    desc.vulkan.physical_device = h.device.physical;
    desc.vulkan.device = h.device.device;
    desc.vulkan.queue_family = h.device.family;
    desc.scene = scene.get();
    desc.output = {320, 180};
    desc.targets.images = &h.image.image;
    desc.targets.views = &h.image.view;
    desc.targets.count = desc.targets.storage = 1;

    masu::renderer m(desc);
    m.load([&](const masu_commands &c) { h.run(c); });
    for (int i = 0; i < 3; i++) {
        masu::frame_desc frame;
        frame.time = i / 60.0;
        h.run(m.frame(frame));
    }
    h.save(image_path);
    masu::renderer moved = std::move(m); // one owner
    try { // a description of another header version is rejected
        desc.bytes -= 8;
        masu::renderer other(desc);
        return 1;
    } catch (const masu::error &e) {
        std::printf("%s: %s\n", masu_result_string(e.result()), e.what());
    }
    std::printf("%s, %u instances, validation %u\n", masu_scene_class_name(scene.scene_class()),
                scene.count(MASU_SCENE_INSTANCE), h.device.messages);
    return moved.get() && !m.get() ? 0 : 1;
}

int main(int argc, char **argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: raii SCENE.masu OUT.png\n"), 2;
    try {
        return render(argv[1], argv[2]);
    } catch (const std::exception &e) {
        return std::fprintf(stderr, "raii: %s\n", e.what()), 1;
    }
}
