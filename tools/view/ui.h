/* ui.h: the user interface drawn over the image, with a C interface. ui.cpp implements it with Dear
 * ImGui and is the viewer's only C++ file. Panels are written with the functions of "Items"; each
 * call is one item of this frame.
 *
 * There is one window and one interface; ui.cpp holds the state. Sizes and positions are in pixels
 * of the window's image; the text size grows with its height. Text is wrapped at the edge of its
 * window, and windows stay inside the image. */
#ifndef MASU_VIEW_UI_H
#define MASU_VIEW_UI_H

#include <SDL.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Lifetime -------------------------------------------------------------------------------- */

/* The device, and the target: an RGBA8 image in COLOR_ATTACHMENT_OPTIMAL, which the interface
 * leaves in TRANSFER_SRC_OPTIMAL. */
typedef struct masu_ui_device {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    uint32_t family;
    VkQueue queue;
    VkCommandPool pool;
    VkImageView view;
    VkExtent2D extent;
    uint32_t flight; /* frames in flight */
} masu_ui_device;

/* Size of all RGBA8 thumbnails for masu_ui_picture. A NULL thumbnail does not exist yet. */
#define MASU_UI_PICTURE_WIDTH 192
#define MASU_UI_PICTURE_HEIGHT 108

void masu_ui_open(void);
void masu_ui_close(void);
/* Call it when the image or the thumbnails change; the device is idle. Copies the thumbnails. */
bool masu_ui_attach(const masu_ui_device *device, const uint8_t *const *pictures, uint32_t count,
                    char *error, size_t size);
void masu_ui_detach(void);

/* Key presses, mouse and text. Returns true if the interface has consumed the event. */
bool masu_ui_event(const SDL_Event *event, double pixels_per_point);
/* Whether keys are consumed by a text field or an open list. */
bool masu_ui_takes_keys(void);

void masu_ui_begin(double seconds);
void masu_ui_end(void);
void masu_ui_record(VkCommandBuffer commands); /* the items since begin, into the image */

/* ---- Windows --------------------------------------------------------------------------------- */

typedef enum masu_ui_place {
    MASU_UI_LEFT,   /* at the upper left corner, sized to its content, no input */
    MASU_UI_RIGHT,  /* full height, at the right edge */
    MASU_UI_BOTTOM, /* lines at the lower edge, no input */
    MASU_UI_MIDDLE, /* at the centre, sized to its content */
    MASU_UI_ALL     /* the whole image */
} masu_ui_place;

/* Items of the window follow, then masu_ui_window_end. focus: moves the keyboard focus to the first
 * item. */
void masu_ui_window(const char *name, masu_ui_place place, bool focus);
void masu_ui_window_end(void);

/* Call masu_ui_tabs; then masu_ui_tab for each tab and, if it returns true, the tab's items and
 * masu_ui_tab_end; then masu_ui_tabs_end. */
void masu_ui_tabs(void);
bool masu_ui_tab(const char *label, bool select);
void masu_ui_tab_end(void);
void masu_ui_tabs_end(void);

/* ---- Items ----------------------------------------------------------------------------------- */

/* Colours, 0xRRGGBB. */
enum {
    MASU_INK = 0xE8ECF0,
    MASU_INK_DIM = 0x9AA6B2,
    MASU_INK_TITLE = 0x7FD4FF,
    MASU_INK_GOOD = 0x8CE99A,
    MASU_INK_WARN = 0xFFC94D,
    MASU_INK_BAD = 0xFF7B6B
};

#ifdef __GNUC__
#define MASU_UI_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define MASU_UI_PRINTF(text, first)
#endif

void masu_ui_text(uint32_t color, const char *format, ...) MASU_UI_PRINTF(2, 3);
/* A row of up to 4 columns, of which all but the first are right-aligned numbers. bar: length of a
 * bar behind the row, 0..1; below 0: none. */
void masu_ui_row(uint32_t color, const char *const *cells, uint32_t count, float bar);
bool masu_ui_section(const char *label, bool open); /* false: folded, skip its items */
bool masu_ui_button(const char *label);
void masu_ui_same_line(void); /* the next item is right of the last one, if it fits */
bool masu_ui_check(const char *label, bool *value);
/* Drag, or Ctrl+click or Enter to type. format is printf's, for a float; logarithmic: the range
 * spans decades. */
bool masu_ui_slider(const char *label, float *value, float low, float high, const char *format,
                    bool logarithmic);
bool masu_ui_choice(const char *label, uint32_t *index, const char *const *names, uint32_t count);
bool masu_ui_color(const char *label, float rgb[3]);
/* Whether the last item was changed and released, by mouse or key. */
bool masu_ui_committed(void);
/* A tooltip of the last item for mouse and keyboard focus. */
void masu_ui_help(const char *text);
void masu_ui_progress(float fraction, const char *text); /* below 0: unknown fraction */
/* A button: a thumbnail with a name below it. `at` is its index in masu_ui_attach. */
bool masu_ui_picture(uint32_t at, const char *label);
void masu_ui_push(uint32_t id); /* distinguishes items of the same label until pop */
void masu_ui_pop(void);

/* ---- On the image, below all windows --------------------------------------------------------- */

void masu_ui_fill(float x, float y, float width, float height, uint32_t color, float opacity);
/* A label at (x, y), moved to be inside the image and, if right is greater than left, between left
 * and right; wrapped if it is wider. */
void masu_ui_label(float x, float y, float left, float right, uint32_t color, const char *text);
float masu_ui_line_height(void);
uint32_t masu_ui_room(void); /* lines between the next item of a window and the lower edge */

#ifdef __cplusplus
}
#endif

#endif
