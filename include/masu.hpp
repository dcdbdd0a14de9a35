/* masu.hpp: the C interface of masu.h for C++17: objects that release what they own, and exceptions
 * of type masu::error with the complete masu_detail. Header only; nothing else of the library is
 * C++. Start with examples/raii.cpp.
 *
 * All names, ranges and contracts are those of masu.h. A masu::renderer owns its host block and
 * calls masu_destroy, for which the device must be idle: declare it after the host's Vulkan device,
 * and wait before it goes out of scope. Handles (instance, model, light) refer to their
 * renderer and are valid as long as it is. */
#ifndef MASU_HPP
#define MASU_HPP

#include "masu.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace masu {

/* ---- Errors ---------------------------------------------------------------------------------- */

/* A call that returned a negative masu_result. what() is masu_detail.text. */
class error : public std::runtime_error {
public:
    explicit error(const masu_detail &cause) : std::runtime_error(cause.text), cause_(cause) {}
    masu_result result() const noexcept { return cause_.result; }
    const masu_detail &detail() const noexcept { return cause_; }

private:
    masu_detail cause_;
};

/* call(f): f receives a masu_detail * and returns a masu_result, which is returned if it is not an
 * error. For functions that have no wrapper here. */
template <typename F> masu_result call(F &&f) {
    masu_detail detail{};
    masu_result result = f(&detail);
    if (result < 0) throw error(detail);
    return result;
}

/* ---- Descriptions ---------------------------------------------------------------------------- */

/* Zero, but for `bytes`. */
struct desc : masu_desc {
    desc() noexcept : masu_desc{} { bytes = sizeof(masu_desc); }
};

struct frame_desc : masu_frame_desc {
    frame_desc() noexcept : masu_frame_desc{} { bytes = sizeof(masu_frame_desc); }
};

using rows = std::array<float, 12>; /* 3x4 matrix, row by row */

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* A validated scene with the bytes of its blob. */
class scene {
public:
    /* Copies `bytes` to aligned memory. */
    scene(const void *bytes, std::size_t size) : blob_(size / sizeof(unit) + 1) {
        if (bytes && size) std::memcpy(static_cast<void *>(blob_.data()), bytes, size);
        call([&](masu_detail *d) { return masu_scene_bind(blob_.data(), size, &scene_, d); });
    }

    scene(scene &&) noexcept = default;
    scene &operator=(scene &&) noexcept = default;

    const masu_scene *get() const noexcept { return &scene_; } /* in this object */
    std::uint32_t count(masu_scene_item item) const { return masu_scene_count(&scene_, item); }
    std::string name(masu_scene_item item, std::uint32_t index) const {
        return masu_scene_name(&scene_, item, index);
    }
    std::optional<std::uint32_t> find(masu_scene_item item, const std::string &name) const {
        std::int32_t i = masu_scene_find(&scene_, item, name.c_str());
        return i < 0 ? std::nullopt : std::optional<std::uint32_t>(i);
    }
    masu_scene_class scene_class() const noexcept { return masu_scene_class_of(&scene_); }

private:
    struct alignas(16) unit {
        unsigned char bytes[16];
    };
    std::vector<unit> blob_;
    masu_scene scene_{};
};

/* ---- Pools of pipelines ---------------------------------------------------------------------- */

/* Outlives the renderers that use it; not movable, because renderers have its address. */
class pipelines {
public:
    explicit pipelines(const masu_vulkan &vulkan) : vulkan_(vulkan), pool_(new masu_pipelines{}) {}
    ~pipelines() { masu_pipelines_destroy(&vulkan_, pool_.get()); }
    pipelines(const pipelines &) = delete;
    pipelines &operator=(const pipelines &) = delete;

    masu_pipelines *get() noexcept { return pool_.get(); }
    masu_pipelines_info info() const {
        masu_pipelines_info out;
        masu_pipelines_info_of(pool_.get(), &out);
        return out;
    }

private:
    masu_vulkan vulkan_;
    std::unique_ptr<masu_pipelines> pool_;
};

/* ---- Objects of a live scene ----------------------------------------------------------------- */

class instance {
public:
    instance() = default;
    instance(masu_renderer *m, masu_instance id) noexcept : m_(m), id_(id) {}
    explicit operator bool() const noexcept { return id_.id != 0; }
    masu_instance id() const noexcept { return id_; }

    masu_instance_state state() const {
        masu_instance_state out;
        call([&](masu_detail *d) { return masu_instance_get(m_, id_, &out, d); });
        return out;
    }
    void transform(const rows &to) {
        call([&](masu_detail *d) { return masu_instance_set_transform(m_, id_, to.data(), d); });
    }
    void position(const double (&to)[3]) {
        call([&](masu_detail *d) { return masu_instance_set_position(m_, id_, to, d); });
    }
    void show(bool shown) {
        call([&](masu_detail *d) { return masu_instance_show(m_, id_, shown, d); });
    }

private:
    masu_renderer *m_ = nullptr;
    masu_instance id_{};
};

class model {
public:
    model() = default;
    model(masu_renderer *m, masu_model id) noexcept : m_(m), id_(id) {}
    explicit operator bool() const noexcept { return id_.id != 0; }
    masu_model id() const noexcept { return id_; }

    masu_model_state state() const {
        masu_model_state out;
        call([&](masu_detail *d) { return masu_model_get(m_, id_, &out, d); });
        return out;
    }
    void transform(const rows &to) {
        call([&](masu_detail *d) { return masu_model_set_transform(m_, id_, to.data(), d); });
    }
    void position(const double (&to)[3]) {
        call([&](masu_detail *d) { return masu_model_set_position(m_, id_, to, d); });
    }
    void show(bool shown) {
        call([&](masu_detail *d) { return masu_model_show(m_, id_, shown, d); });
    }
    void animate(const masu_clip_use *uses, std::uint32_t count) {
        call([&](masu_detail *d) { return masu_model_animate(m_, id_, uses, count, d); });
    }
    model add(const rows &at) { /* a copy: masu_model_add */
        masu_model out;
        call([&](masu_detail *d) { return masu_model_add(m_, id_, at.data(), &out, d); });
        return {m_, out};
    }
    void replace(const masu_mesh_data &to) { /* of renderer::create_mesh */
        call([&](masu_detail *d) { return masu_mesh_replace(m_, id_, &to, d); });
    }
    void deform(const float *positions, const float *normals, std::uint32_t count) {
        call([&](masu_detail *d) { return masu_mesh_deform(m_, id_, positions, normals, count, d); });
    }
    void remove() {
        call([&](masu_detail *d) { return masu_model_remove(m_, id_, d); });
        id_ = {};
    }

private:
    masu_renderer *m_ = nullptr;
    masu_model id_{};
};

class light {
public:
    light() = default;
    light(masu_renderer *m, masu_punctual_light id) noexcept : m_(m), id_(id) {}
    explicit operator bool() const noexcept { return id_.id != 0; }
    masu_punctual_light id() const noexcept { return id_; }

    masu_punctual_light_state state() const {
        masu_punctual_light_state out;
        call([&](masu_detail *d) { return masu_punctual_light_get(m_, id_, &out, d); });
        return out;
    }
    void set(const masu_punctual_light_state &to) {
        call([&](masu_detail *d) { return masu_punctual_light_set(m_, id_, &to, d); });
    }
    void remove() {
        call([&](masu_detail *d) { return masu_punctual_light_remove(m_, id_, d); });
        id_ = {};
    }

private:
    masu_renderer *m_ = nullptr;
    masu_punctual_light id_{};
};

/* ---- Renderer -------------------------------------------------------------------------------- */

class renderer {
public:
    /* masu_memory_query and masu_init in a block of its own. */
    explicit renderer(const masu_desc &desc) {
        masu_memory need = query(desc);
        block_.reset(new (std::align_val_t{64}) unsigned char[need.host_bytes]);
        call([&](masu_detail *d) {
            return masu_init(&desc, block_.get(), need.host_bytes, &m_, d);
        });
    }
    ~renderer() { masu_destroy(m_); }
    renderer(renderer &&from) noexcept
        : block_(std::move(from.block_)), m_(std::exchange(from.m_, nullptr)) {}
    renderer &operator=(renderer &&from) noexcept {
        if (this == &from) return *this;
        masu_destroy(m_);
        block_ = std::move(from.block_);
        m_ = std::exchange(from.m_, nullptr);
        return *this;
    }

    static masu_memory query(const masu_desc &desc) {
        masu_memory need;
        call([&](masu_detail *d) { return masu_memory_query(&desc, &need, d); });
        return need;
    }

    masu_renderer *get() const noexcept { return m_; }

    /* Loads the scene. submit(commands) submits and waits; steps without commands are skipped. */
    template <typename F> void load(F &&submit) {
        masu_commands c;
        while (call([&](masu_detail *d) { return masu_load(m_, &c, d); }) == MASU_INCOMPLETE)
            if (c.part_count) submit(c);
    }
    masu_commands frame(const masu_frame_desc &desc) {
        masu_commands c;
        call([&](masu_detail *d) { return masu_frame(m_, &desc, &c, d); });
        return c;
    }
    void resize(VkExtent2D output, const masu_targets &targets) {
        call([&](masu_detail *d) { return masu_resize(m_, output, &targets, nullptr, d); });
    }

    instance find_instance(const std::string &name) const {
        return {m_, masu_instance_find(m_, name.c_str())};
    }
    model create_mesh(std::uint32_t kind, const masu_mesh_data &data, const rows &at) {
        masu_model out;
        call([&](masu_detail *d) { return masu_mesh_create(m_, kind, &data, at.data(), &out, d); });
        return {m_, out};
    }
    model find_model(const std::string &name) const {
        return {m_, masu_model_find(m_, name.c_str())};
    }
    light find_light(const std::string &name) const {
        return {m_, masu_punctual_light_find(m_, name.c_str())};
    }
    light add_light(const masu_punctual_light_state &state) {
        masu_punctual_light out;
        call([&](masu_detail *d) { return masu_punctual_light_add(m_, &state, &out, d); });
        return {m_, out};
    }

    /* Empty while the frame of the slot is unfinished (MASU_INCOMPLETE). */
    std::optional<masu_stats_info> stats(std::uint32_t slot) const {
        masu_stats_info out;
        auto result = call([&](masu_detail *d) { return masu_stats(m_, slot, &out, d); });
        return result == MASU_OK ? std::optional<masu_stats_info>(out) : std::nullopt;
    }

private:
    struct aligned_delete {
        void operator()(unsigned char *p) const { ::operator delete[](p, std::align_val_t{64}); }
    };
    std::unique_ptr<unsigned char[], aligned_delete> block_;
    masu_renderer *m_ = nullptr;
};

} // namespace masu

#endif
