/* ui.cpp: implements ui.h with Dear ImGui (libimgui-dev), its Vulkan backend, and SDL's events. */
#include "ui.h"

#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

/* The font, DejaVu Sans, is embedded in the program. */
extern "C" const unsigned char masu_ui_font[], masu_ui_font_end[];
__asm__(".section .rodata\n.globl masu_ui_font, masu_ui_font_end\n.balign 16\n"
        "masu_ui_font:\n.incbin \"" MASU_UI_FONT "\"\nmasu_ui_font_end:\n.byte 0\n.previous\n");

namespace {

struct {
    masu_ui_device d;
    VkRenderPass pass;
    VkFramebuffer frame;
    VkDescriptorPool sets;
    bool renders; /* ImGui_ImplVulkan_Init has been called */
    int rects[256];
    uint32_t pictures;
    float right,
        edge; /* x of the left edge of the panel at the right: in this frame so far, in the last
               * frame */
    ImVec2 left; /* size of the window at the upper left in this frame */
    float bottom,
        lines; /* height of the lines at the lower edge: in the last frame, in this frame so far */
    bool fresh_keys[512],
        fresh_buttons[3]; /* pressed since the last frame: a short press counts as held for one
                           * frame */
    bool keys[512], buttons[3];
    VkResult failed;
} ui;

float em() { return ImGui::GetFontSize(); }

ImU32 color_of(uint32_t rgb, float opacity = 1.0f) {
    return IM_COL32(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255, (int)(opacity * 255.0f + 0.5f));
}

void check(VkResult r) {
    if (r && !ui.failed) ui.failed = r;
}

/* About 45 lines of text fit; text is smaller if the window is too narrow for the panels. */
float font_pixels(VkExtent2D e) {
    return std::floor(std::max(11.0f, std::min((float)e.height / 45.0f, (float)e.width / 60.0f)));
}

void set_style(float pixels) {
    ImGuiStyle &s = ImGui::GetStyle();
    s = ImGuiStyle();
    ImGui::StyleColorsDark(&s);
    s.ScaleAllSizes(pixels / 15.0f);
    s.WindowRounding = s.FrameRounding = s.GrabRounding = 0.2f * pixels;
    s.WindowBorderSize = 0.0f;
    s.Colors[ImGuiCol_WindowBg] = ImVec4(0.043f, 0.063f, 0.086f, 0.84f);
    s.Colors[ImGuiCol_PopupBg] = ImVec4(0.043f, 0.063f, 0.086f, 0.97f);
    s.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(color_of(MASU_INK));
    s.Colors[ImGuiCol_NavHighlight] = ImGui::ColorConvertU32ToFloat4(color_of(MASU_INK_WARN));
}

bool make_pass() {
    VkAttachmentDescription color = {};
    color.format = VK_FORMAT_R8G8B8A8_UNORM;
    color.samples = VK_SAMPLE_COUNT_1_BIT;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    color.finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    VkAttachmentReference to = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &to;
    VkSubpassDependency after = {};
    after.dstSubpass = VK_SUBPASS_EXTERNAL;
    after.srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    after.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    after.dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
    after.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    VkRenderPassCreateInfo pass = {};
    pass.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    pass.attachmentCount = 1;
    pass.pAttachments = &color;
    pass.subpassCount = 1;
    pass.pSubpasses = &subpass;
    pass.dependencyCount = 1;
    pass.pDependencies = &after;
    if (vkCreateRenderPass(ui.d.device, &pass, nullptr, &ui.pass)) return false;
    VkFramebufferCreateInfo frame = {};
    frame.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    frame.renderPass = ui.pass;
    frame.attachmentCount = 1;
    frame.pAttachments = &ui.d.view;
    frame.width = ui.d.extent.width;
    frame.height = ui.d.extent.height;
    frame.layers = 1;
    return !vkCreateFramebuffer(ui.d.device, &frame, nullptr, &ui.frame);
}

/* Packs the font at its size and the thumbnails into one texture. */
void make_atlas(const uint8_t *const *pictures, uint32_t count) {
    const int w = MASU_UI_PICTURE_WIDTH, h = MASU_UI_PICTURE_HEIGHT;
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    ImFontConfig config;
    float pixels = font_pixels(ui.d.extent);
    config.FontDataOwnedByAtlas = false;
    atlas->Clear();
    atlas->AddFontFromMemoryTTF((void *)masu_ui_font, (int)(masu_ui_font_end - masu_ui_font),
                                pixels, &config);
    ui.pictures = std::min(count, (uint32_t)(sizeof ui.rects / sizeof *ui.rects));
    for (uint32_t i = 0; i < ui.pictures; i++)
        ui.rects[i] = pictures[i] ? atlas->AddCustomRectRegular(w, h) : -1;
    atlas->Build();
    unsigned char *texels;
    int width, height;
    atlas->GetTexDataAsRGBA32(&texels, &width, &height);
    for (uint32_t i = 0; i < ui.pictures; i++) {
        if (ui.rects[i] < 0) continue;
        const ImFontAtlasCustomRect *r = atlas->GetCustomRectByIndex(ui.rects[i]);
        for (int y = 0; y < h; y++) {
            memcpy(texels + 4 * ((size_t)(r->Y + y) * (size_t)width + r->X),
                   pictures[i] + 4 * (size_t)(y * w), 4 * (size_t)w);
        }
    }
    set_style(pixels);
}

bool upload() {
    VkCommandBufferAllocateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    info.commandPool = ui.d.pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    VkCommandBufferBeginInfo begin = {};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VkCommandBuffer cmd;
    VkResult r = vkAllocateCommandBuffers(ui.d.device, &info, &cmd);
    if (r) return false;
    r = vkBeginCommandBuffer(cmd, &begin);
    bool good = !r && ImGui_ImplVulkan_CreateFontsTexture(cmd);
    VkSubmitInfo submit = {};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &cmd;
    good = good && !vkEndCommandBuffer(cmd) &&
           !vkQueueSubmit(ui.d.queue, 1, &submit, VK_NULL_HANDLE) && !vkQueueWaitIdle(ui.d.queue);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
    vkFreeCommandBuffers(ui.d.device, ui.d.pool, 1, &cmd);
    return good && !ui.failed;
}

bool make_renderer() {
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo pool = {};
    pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool.maxSets = 1;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    if (vkCreateDescriptorPool(ui.d.device, &pool, nullptr, &ui.sets)) return false;
    ImGui_ImplVulkan_InitInfo info = {};
    info.Instance = ui.d.instance;
    info.PhysicalDevice = ui.d.physical;
    info.Device = ui.d.device;
    info.QueueFamily = ui.d.family;
    info.Queue = ui.d.queue;
    info.DescriptorPool = ui.sets;
    info.MinImageCount = info.ImageCount = ui.d.flight + 1;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    info.CheckVkResultFn = check;
    ui.renders = ImGui_ImplVulkan_Init(&info, ui.pass);
    return ui.renders && upload();
}

/* The requested size of a window, limited to the image. */
ImVec2 within(float width, float height) {
    return ImVec2(std::min(width, (float)ui.d.extent.width),
                  std::min(height, (float)ui.d.extent.height));
}

/* Draws a label. The item uses the rest of the line, or the next line. Returns the item's hidden
 * name. */
const char *labelled(const char *label) {
    static char hidden[300];
    float width = ImGui::GetContentRegionAvail().x, column = 0.42f * width;
    ImGui::AlignTextToFramePadding();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(label, ImGui::FindRenderedTextEnd(label));
    ImGui::PopTextWrapPos();
    if (ImGui::GetItemRectSize().x <= column)
        ImGui::SameLine(column + ImGui::GetStyle().WindowPadding.x);
    ImGui::SetNextItemWidth(-1.0f);
    snprintf(hidden, sizeof hidden, "##%s", label);
    return hidden;
}

} // namespace

/* ---- Lifetime -------------------------------------------------------------------------------- */

void masu_ui_open(void) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    static const struct {
        int key, scancode;
    } keys[] = {{ImGuiKey_Tab, SDL_SCANCODE_TAB},
                {ImGuiKey_LeftArrow, SDL_SCANCODE_LEFT},
                {ImGuiKey_RightArrow, SDL_SCANCODE_RIGHT},
                {ImGuiKey_UpArrow, SDL_SCANCODE_UP},
                {ImGuiKey_DownArrow, SDL_SCANCODE_DOWN},
                {ImGuiKey_Home, SDL_SCANCODE_HOME},
                {ImGuiKey_End, SDL_SCANCODE_END},
                {ImGuiKey_Delete, SDL_SCANCODE_DELETE},
                {ImGuiKey_Backspace, SDL_SCANCODE_BACKSPACE},
                {ImGuiKey_Space, SDL_SCANCODE_SPACE},
                {ImGuiKey_Enter, SDL_SCANCODE_RETURN},
                {ImGuiKey_KeyPadEnter, SDL_SCANCODE_KP_ENTER},
                {ImGuiKey_Escape, SDL_SCANCODE_ESCAPE},
                {ImGuiKey_A, SDL_SCANCODE_A},
                {ImGuiKey_C, SDL_SCANCODE_C},
                {ImGuiKey_V, SDL_SCANCODE_V},
                {ImGuiKey_X, SDL_SCANCODE_X}};
    for (const auto &k : keys) io.KeyMap[k.key] = k.scancode;
    io.MousePos = ImVec2(-FLT_MAX, -FLT_MAX);
}

void masu_ui_close(void) {
    if (ImGui::GetCurrentContext()) ImGui::DestroyContext();
}

bool masu_ui_attach(const masu_ui_device *device, const uint8_t *const *pictures, uint32_t count,
                    char *error, size_t size) {
    masu_ui_detach();
    ui.d = *device;
    ui.failed = VK_SUCCESS;
    make_atlas(pictures, count);
    if (make_pass() && make_renderer()) return true;
    snprintf(error, size, "the user interface cannot be created (VkResult %d)", (int)ui.failed);
    return false;
}

void masu_ui_detach(void) {
    if (!ui.d.device) return;
    if (ui.renders) ImGui_ImplVulkan_Shutdown();
    ui.renders = false;
    vkDestroyDescriptorPool(ui.d.device, ui.sets, nullptr);
    vkDestroyFramebuffer(ui.d.device, ui.frame, nullptr);
    vkDestroyRenderPass(ui.d.device, ui.pass, nullptr);
    ui.sets = VK_NULL_HANDLE;
    ui.frame = VK_NULL_HANDLE;
    ui.pass = VK_NULL_HANDLE;
    ui.d.device = VK_NULL_HANDLE;
}

/* Keys that move the focus or change an item, while a window has the keyboard focus. */
static bool is_of_windows(SDL_Keycode key) {
    switch (key) {
    case SDLK_LEFT:
    case SDLK_RIGHT:
    case SDLK_UP:
    case SDLK_DOWN:
    case SDLK_RETURN:
    case SDLK_KP_ENTER:
    case SDLK_SPACE:
    case SDLK_HOME:
    case SDLK_END:
    case SDLK_BACKSPACE:
    case SDLK_DELETE: return true;
    default: return false;
    }
}

bool masu_ui_takes_keys(void) {
    ImGuiContext *c = ImGui::GetCurrentContext();
    return c && (c->ActiveId != 0 || c->OpenPopupStack.Size > 0) && c->IO.WantCaptureKeyboard;
}

bool masu_ui_event(const SDL_Event *e, double scale) {
    ImGuiIO &io = ImGui::GetIO();
    int button;
    switch (e->type) {
    case SDL_MOUSEMOTION:
        io.MousePos = ImVec2((float)(e->motion.x * scale), (float)(e->motion.y * scale));
        return io.WantCaptureMouse;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        if (e->button.which == SDL_TOUCH_MOUSEID) return false;
        io.MousePos = ImVec2((float)(e->button.x * scale), (float)(e->button.y * scale));
        button = e->button.button == SDL_BUTTON_LEFT    ? 0
                 : e->button.button == SDL_BUTTON_RIGHT ? 1
                                                        : 2;
        ui.buttons[button] = e->type == SDL_MOUSEBUTTONDOWN;
        if (ui.buttons[button]) ui.fresh_buttons[button] = true;
        /* Checks the windows of the last frame, because WantCaptureMouse is updated by the next
         * one. */
        for (ImGuiWindow *w : ImGui::GetCurrentContext()->Windows) {
            if (w->WasActive && !(w->Flags & ImGuiWindowFlags_NoMouseInputs) &&
                w->Rect().Contains(io.MousePos))
                return true;
        }
        return io.WantCaptureMouse && !ui.buttons[button];
    case SDL_MOUSEWHEEL:
        if (!io.WantCaptureMouse) return false;
        io.MouseWheel += (float)e->wheel.y;
        return true;
    case SDL_TEXTINPUT: io.AddInputCharactersUTF8(e->text.text); return io.WantTextInput;
    case SDL_KEYDOWN:
    case SDL_KEYUP: {
        SDL_Scancode code = SDL_GetScancodeFromKey(e->key.keysym.sym);
        bool down = e->type == SDL_KEYDOWN;
        if (code <= 0 || code >= 512) return false;
        bool takes = masu_ui_takes_keys() || (io.NavActive && is_of_windows(e->key.keysym.sym));
        if (down && !takes) return false;
        ui.keys[code] = down;
        if (down) ui.fresh_keys[code] = true;
        io.KeyCtrl = (e->key.keysym.mod & KMOD_CTRL) != 0;
        io.KeyShift = (e->key.keysym.mod & KMOD_SHIFT) != 0;
        return down;
    }
    case SDL_WINDOWEVENT:
        if (e->window.event == SDL_WINDOWEVENT_FOCUS_LOST) {
            memset(ui.keys, 0, sizeof ui.keys);
            memset(ui.buttons, 0, sizeof ui.buttons);
        }
        return false;
    default: return false;
    }
}

void masu_ui_begin(double seconds) {
    ImGuiIO &io = ImGui::GetIO();
    io.DisplaySize = ImVec2((float)ui.d.extent.width, (float)ui.d.extent.height);
    io.DeltaTime = seconds > 1e-4 ? (float)seconds : 1e-4f;
    for (int i = 0; i < 512; i++)
        io.KeysDown[i] = ui.keys[i] || ui.fresh_keys[i], ui.fresh_keys[i] = false;
    for (int i = 0; i < 3; i++)
        io.MouseDown[i] = ui.buttons[i] || ui.fresh_buttons[i], ui.fresh_buttons[i] = false;
    ui.edge = ui.right;
    ui.right = io.DisplaySize.x;
    ui.left = ImVec2(0, 0);
    ui.bottom = ui.lines;
    ui.lines = 0.0f;
    ImGui_ImplVulkan_NewFrame();
    ImGui::NewFrame();
}

void masu_ui_end(void) { ImGui::Render(); }

void masu_ui_record(VkCommandBuffer commands) {
    VkRenderPassBeginInfo begin = {};
    begin.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    begin.renderPass = ui.pass;
    begin.framebuffer = ui.frame;
    begin.renderArea.extent = ui.d.extent;
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
}

/* ---- Windows --------------------------------------------------------------------------------- */

void masu_ui_window(const char *name, masu_ui_place place, bool focus) {
    const float width = (float)ui.d.extent.width, height = (float)ui.d.extent.height;
    const ImGuiWindowFlags still = ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration & ~ImGuiWindowFlags_NoScrollbar;
    flags |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
             ImGuiWindowFlags_NoFocusOnAppearing;
    ImVec2 panel = within(28.0f * em(), height), lines = within(ui.right, 0.3f * height);
    switch (place) {
    case MASU_UI_LEFT:
        ImGui::SetNextWindowPos(ImVec2(0, 0));
        panel = within(std::min(27.0f * em(), ui.edge), height);
        ImGui::SetNextWindowSize(ImVec2(panel.x, 0.0f));
        ImGui::SetNextWindowSizeConstraints(ImVec2(panel.x, 0.0f),
                                            ImVec2(panel.x, height - ui.bottom));
        flags |= still;
        break;
    case MASU_UI_RIGHT:
        ui.right = width - panel.x;
        ImGui::SetNextWindowPos(ImVec2(ui.right, 0));
        ImGui::SetNextWindowSize(ImVec2(panel.x, height));
        break;
    case MASU_UI_BOTTOM:
        ImGui::SetNextWindowPos(ImVec2(0, height - ui.lines), 0, ImVec2(0, 1));
        ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(lines.x, height));
        flags |= still | ImGuiWindowFlags_AlwaysAutoResize;
        break;
    case MASU_UI_MIDDLE:
        ImGui::SetNextWindowPos(ImVec2(0.5f * width, 0.5f * height), 0, ImVec2(0.5f, 0.5f));
        ImGui::SetNextWindowSize(ImVec2(within(30.0f * em(), height).x, 0.0f));
        break;
    case MASU_UI_ALL:
        ImGui::SetNextWindowPos(ImVec2(0, 0));
        ImGui::SetNextWindowSize(ImVec2(width, height - ui.bottom));
        flags |= ImGuiWindowFlags_NoBringToFrontOnFocus;
        break;
    }
    if (focus) ImGui::SetNextWindowFocus();
    ImGui::Begin(name, nullptr, flags);
    if (place == MASU_UI_LEFT) ui.left = ImGui::GetWindowSize();
    if (place == MASU_UI_BOTTOM) ui.lines += ImGui::GetWindowHeight();
    if (focus) ImGui::GetCurrentContext()->NavDisableHighlight = false;
}

void masu_ui_window_end(void) { ImGui::End(); }
void masu_ui_tabs(void) { ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyScroll); }
void masu_ui_tabs_end(void) { ImGui::EndTabBar(); }
void masu_ui_tab_end(void) { ImGui::EndTabItem(); }
bool masu_ui_tab(const char *label, bool select) {
    return ImGui::BeginTabItem(label, nullptr, select ? ImGuiTabItemFlags_SetSelected : 0);
}

/* ---- Items ----------------------------------------------------------------------------------- */

/* Lines at the lower edge use the width of the image: their window fits itself to them. */
static void wrapped(uint32_t color, const char *text) {
    ImGuiWindow *w = ImGui::GetCurrentWindow();
    bool fits = (w->Flags & ImGuiWindowFlags_AlwaysAutoResize) != 0;
    ImGui::PushStyleColor(ImGuiCol_Text, color_of(color));
    ImGui::PushTextWrapPos(fits ? ui.right - ImGui::GetStyle().WindowPadding.x : 0.0f);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void masu_ui_text(uint32_t color, const char *format, ...) {
    char text[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    wrapped(color, text);
}

void masu_ui_row(uint32_t color, const char *const *cells, uint32_t count, float bar) {
    float width = ImGui::GetContentRegionAvail().x, from = 0.40f * width;
    ImVec2 at = ImGui::GetCursorScreenPos();
    if (bar >= 0.0f) {
        float end = std::max(bar * 0.36f * width, 1.0f);
        ImGui::GetWindowDrawList()->AddRectFilled(
            ImVec2(at.x + 0.62f * width, at.y + 0.25f * em()),
            ImVec2(at.x + 0.62f * width + end, at.y + 0.8f * em()), color_of(0x4FA3E0, 0.86f));
        width *= 0.6f;
    }
    ImGui::PushStyleColor(ImGuiCol_Text, color_of(color));
    for (uint32_t i = 0; i < count; i++) {
        float part = (width - from) / (float)(count > 1 ? count - 1 : 1);
        if (i)
            ImGui::SameLine(from + part * (float)i - ImGui::CalcTextSize(cells[i]).x +
                            ImGui::GetStyle().WindowPadding.x);
        ImGui::TextUnformatted(cells[i]);
    }
    ImGui::PopStyleColor();
}

bool masu_ui_section(const char *label, bool open) {
    return ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

bool masu_ui_button(const char *label) { return ImGui::Button(label); }

void masu_ui_same_line(void) {
    ImGuiWindow *w = ImGui::GetCurrentWindow();
    float room = w->WorkRect.Max.x - ImGui::GetItemRectMax().x;
    if (room > 7.0f * em()) ImGui::SameLine();
}

bool masu_ui_check(const char *label, bool *value) { return ImGui::Checkbox(label, value); }

bool masu_ui_slider(const char *label, float *value, float low, float high, const char *format,
                    bool logarithmic) {
    return ImGui::SliderFloat(labelled(label), value, low, high, format,
                              ImGuiSliderFlags_AlwaysClamp |
                                  (logarithmic ? ImGuiSliderFlags_Logarithmic : 0));
}

/* A selected name that is too long for its half of the line is shortened, and shown in full below
 * the line. */
bool masu_ui_choice(const char *label, uint32_t *index, const char *const *names, uint32_t count) {
    bool changed = false;
    const char *chosen = *index < count ? names[*index] : "", *hidden = labelled(label);
    char text[300];
    float room = ImGui::GetContentRegionAvail().x - 1.5f * ImGui::GetFrameHeight();
    size_t fits = strlen(chosen), length = fits;
    snprintf(text, sizeof text, "%.290s", chosen);
    while (fits > 1 && ImGui::CalcTextSize(text).x > room)
        snprintf(text, sizeof text, "%.*s...", (int)std::min(--fits, (size_t)290), chosen);
    if (ImGui::BeginCombo(hidden, text, ImGuiComboFlags_HeightLarge)) {
        for (uint32_t i = 0; i < count; i++) {
            ImGui::PushID((int)i);
            if (ImGui::Selectable(names[i], i == *index)) changed = i != *index, *index = i;
            if (i == *index) ImGui::SetItemDefaultFocus();
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    if (fits < length) wrapped(MASU_INK_DIM, chosen);
    return changed;
}

bool masu_ui_color(const char *label, float rgb[3]) {
    return ImGui::ColorEdit3(labelled(label), rgb,
                             ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR |
                                 ImGuiColorEditFlags_NoLabel);
}

bool masu_ui_committed(void) { return ImGui::IsItemDeactivatedAfterEdit(); }

void masu_ui_help(const char *text) {
    if (!ImGui::IsItemHovered() &&
        !(ImGui::IsItemFocused() && !ImGui::GetCurrentContext()->NavDisableHighlight))
        return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(std::min(26.0f * em(), 0.8f * (float)ui.d.extent.width));
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void masu_ui_progress(float fraction, const char *text) {
    bool fits = (ImGui::GetCurrentWindow()->Flags & ImGuiWindowFlags_AlwaysAutoResize) != 0;
    float width = fits ? std::min(30.0f * em(), ui.right) - 2.0f * ImGui::GetStyle().WindowPadding.x
                       : ImGui::GetContentRegionAvail().x;
    if (fraction < 0.0f) { /* moves back and forth */
        ImVec2 at = ImGui::GetCursorScreenPos();
        float x = (float)std::fmod(ImGui::GetTime() * 0.5, 2.0);
        x = (x > 1.0f ? 2.0f - x : x) * 0.75f * width;
        ImGui::ProgressBar(0.0f, ImVec2(width, 0.0f), "");
        ImGui::GetWindowDrawList()->AddRectFilled(
            ImVec2(at.x + x, at.y),
            ImVec2(at.x + x + 0.25f * width, at.y + ImGui::GetFrameHeight()),
            ImGui::GetColorU32(ImGuiCol_PlotHistogram));
    } else {
        ImGui::ProgressBar(std::min(fraction, 1.0f), ImVec2(width, 0.0f), "");
    }
    wrapped(MASU_INK_DIM, text);
}

bool masu_ui_picture(uint32_t at, const char *label) {
    ImGuiStyle &s = ImGui::GetStyle();
    float width = 12.0f * em(), height = width * MASU_UI_PICTURE_HEIGHT / MASU_UI_PICTURE_WIDTH;
    bool pressed;
    ImGui::BeginGroup();
    ImGui::PushID((int)at);
    if (at < ui.pictures && ui.rects[at] >= 0) {
        ImFontAtlas *atlas = ImGui::GetIO().Fonts;
        ImVec2 from, to;
        atlas->CalcCustomRectUV(atlas->GetCustomRectByIndex(ui.rects[at]), &from, &to);
        pressed = ImGui::ImageButton(atlas->TexID, ImVec2(width, height), from, to);
    } else {
        pressed = ImGui::Button(
            "##none", ImVec2(width + 2 * s.FramePadding.x, height + 2 * s.FramePadding.y));
    }
    ImGui::PopID();
    ImGui::TextUnformatted(label);
    ImGui::EndGroup();
    if (ImGui::GetItemRectMax().x + s.ItemSpacing.x + width + 2 * s.FramePadding.x <
        ImGui::GetCurrentWindow()->WorkRect.Max.x)
        ImGui::SameLine();
    return pressed;
}

void masu_ui_push(uint32_t id) { ImGui::PushID((int)id); }
void masu_ui_pop(void) { ImGui::PopID(); }

/* ---- On the image ---------------------------------------------------------------------------- */

float masu_ui_line_height(void) { return ImGui::GetTextLineHeight(); }

void masu_ui_fill(float x, float y, float width, float height, uint32_t color, float opacity) {
    ImGui::GetBackgroundDrawList()->AddRectFilled(ImVec2(x, y), ImVec2(x + width, y + height),
                                                  color_of(color, opacity));
}

uint32_t masu_ui_room(void) {
    float room = (float)ui.d.extent.height - ui.bottom - ImGui::GetCursorScreenPos().y -
                 ImGui::GetStyle().WindowPadding.y;
    return room > 0.0f ? (uint32_t)(room / ImGui::GetTextLineHeightWithSpacing()) : 0;
}

/* Keeps the label clear of the panels and of the lines at the lower edge. */
void masu_ui_label(float x, float y, float left, float right, uint32_t color, const char *text) {
    const float pad = 0.4f * em();
    if (!(right > left)) left = 0.0f, right = (float)ui.d.extent.width;
    right = std::min(right, ui.edge);
    if (y < ui.left.y) left = std::max(left, ui.left.x);
    float room = right - left - 2.0f * pad;
    if (room < 2.0f * em()) return;
    ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, room);
    x = std::max(std::min(x, right - size.x - 2.0f * pad), left);
    y = std::max(std::min(y, (float)ui.d.extent.height - ui.bottom - size.y - 2.0f * pad), 0.0f);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(x, y), ImVec2(x + size.x + 2 * pad, y + size.y + 2 * pad),
                        color_of(0x0B1016, 0.8f));
    list->AddText(ImGui::GetFont(), em(), ImVec2(x + pad, y + pad), color_of(color), text, nullptr,
                  room);
}
