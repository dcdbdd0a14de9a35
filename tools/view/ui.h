/* ui.h: the user interface that is drawn over the picture, as calls of C: Dear ImGui behind ui.cpp,
 * the only file of C++ of the viewer. Panels are written with the functions of "Items"; each call
 * is one item of this frame.
 *
 * One window, one interface: the state is the library's own. Sizes and positions are pixels of the
 * window's image, text grows with its height. Text is wrapped at the edge of its window, and
 * windows stay inside of the image. */
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

/* ---- Life ------------------------------------------------------------------------------------ */

/* What it draws with, and on: an RGBA8 image in COLOR_ATTACHMENT_OPTIMAL, which it leaves in
 * TRANSFER_SRC_OPTIMAL. */
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

/* A small RGBA8 picture for masu_ui_picture; all have one size. NULL: not there yet. */
#define MASU_UI_PICTURE_WIDTH 192
#define MASU_UI_PICTURE_HEIGHT 108

void masu_ui_open(void);
void masu_ui_close(void);
/* Whenever the image or the pictures change; the device is idle. The pictures are copied. */
bool masu_ui_attach(const masu_ui_device *device, const uint8_t *const *pictures, uint32_t count,
                    char *error, size_t size);
void masu_ui_detach(void);

/* Key presses, mouse and text. True: it is the interface's, and nothing else should happen. */
bool masu_ui_event(const SDL_Event *event, double pixels_per_point);
/* Whether a key, held or pressed, goes to a text field or an open list. */
bool masu_ui_takes_keys(void);

void masu_ui_begin(double seconds);
void masu_ui_end(void);
void masu_ui_record(VkCommandBuffer commands); /* what lies between begin and end, into the image */

/* ---- Windows --------------------------------------------------------------------------------- */

typedef enum masu_ui_place {
    MASU_UI_LEFT,   /* at the upper left corner, as large as its content, takes no input */
    MASU_UI_RIGHT,  /* as high as the image, at its right edge */
    MASU_UI_BOTTOM, /* lines at the lower edge, takes no input */
    MASU_UI_MIDDLE, /* in the middle, as large as its content */
    MASU_UI_ALL     /* all of the image */
} masu_ui_place;

/* Its items follow; then masu_ui_window_end. focus: the keyboard is at its first item. */
void masu_ui_window(const char *name, masu_ui_place place, bool focus);
void masu_ui_window_end(void);

/* Tabs: masu_ui_tabs, for each masu_ui_tab with its items and masu_ui_tab_end if it is true,
 * masu_ui_tabs_end. */
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
/* A row of up to 4 columns, of which all but the first are right-aligned numbers; bar: 0..1 behind
 * it, below 0: none. */
void masu_ui_row(uint32_t color, const char *const *cells, uint32_t count, float bar);
bool masu_ui_section(const char *label, bool open); /* false: folded, leave its items out */
bool masu_ui_button(const char *label);
void masu_ui_same_line(void); /* the next item is beside the last one, if it fits */
bool masu_ui_check(const char *label, bool *value);
/* Drag, or Ctrl+click or Enter to type. format is printf's, of a float; logarithmic: the range
 * spans decades. */
bool masu_ui_slider(const char *label, float *value, float low, float high, const char *format,
                    bool logarithmic);
bool masu_ui_choice(const char *label, uint32_t *index, const char *const *names, uint32_t count);
bool masu_ui_color(const char *label, float rgb[3]);
/* The last item was changed and has been let go, by mouse or key. */
bool masu_ui_committed(void);
/* A text beside the last item while the mouse or the keyboard is on it. */
void masu_ui_help(const char *text);
void masu_ui_progress(float fraction, const char *text); /* below 0: not known how much */
/* A picture with a name below it, which is a button; `at` is its number in masu_ui_attach. */
bool masu_ui_picture(uint32_t at, const char *label);
void masu_ui_push(uint32_t id); /* items of the same label differ between push and pop */
void masu_ui_pop(void);

/* ---- On the picture, below all windows ------------------------------------------------------- */

void masu_ui_fill(float x, float y, float width, float height, uint32_t color, float opacity);
/* A label at (x, y), moved so that it is inside of the image and, if right is more than left,
 * between those; wrapped if it is wider. */
void masu_ui_label(float x, float y, float left, float right, uint32_t color, const char *text);
float masu_ui_line_height(void);
uint32_t masu_ui_room(void); /* lines between the next item of a window and the lower edge */

#ifdef __cplusplus
}
#endif

#endif
