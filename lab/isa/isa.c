/* isa.c: see isa.h. */
#include "lab/isa/isa.h"
#include "lab/isa/null_device.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const masu_isa_field_names[MASU_ISA_FIELD_COUNT] = {
#define MASU_ISA_NAME(ID, name, ...) name,
    MASU_ISA_FIELDS(MASU_ISA_NAME)
#undef MASU_ISA_NAME
};

/* Handles that are never used. */
static void give_targets(masu_desc *desc) {
    static const VkImage image = (VkImage)(uintptr_t)1;
    static const VkImageView view = (VkImageView)(uintptr_t)1;
    desc->targets.images = &image;
    desc->targets.views = &view;
    desc->targets.count = 1;
    desc->targets.storage = 1;
}

static bool compile(masu_desc *desc, char *error, size_t size) {
    masu_detail detail;
    masu_memory need;
    masu_renderer *m = NULL;
    bool good = !masu_memory_query(desc, &need, &detail);
    void *block = NULL;
    if (good) {
        size_t align = (size_t)need.host_alignment;
        block = aligned_alloc(align, ((size_t)need.host_bytes + align - 1) / align * align);
        good = block && !masu_init(desc, block, need.host_bytes, &m, &detail);
        if (!block) snprintf(detail.text, sizeof detail.text, "out of memory");
    }
    if (good) return true; /* not destroyed: a thread of V3DV would crash without its GPU */
    snprintf(error, size, "%s", detail.text);
    free(block);
    return false;
}

bool masu_isa_compile(const masu_desc *given, void (*before)(const char *pass), masu_isa_rows *rows,
                      char *error, size_t error_size) {
    masu_null_device device;
    masu_desc desc = *given;
    desc.bytes = sizeof desc;
    memset(rows, 0, sizeof *rows);
    if (!masu_null_device_open(&device, before, rows, error, error_size)) return false;
    desc.vulkan =
        (masu_vulkan){.get_instance_proc_addr = masu_null_get_instance_proc_addr,
                      .instance = device.instance,
                      .physical_device = device.physical,
                      .device = device.device,
                      .queue_family = device.family,
                      .texture_compression_bc = device.compressed,
                      .max_anisotropy = desc.vulkan.max_anisotropy > device.most_anisotropy
                                            ? device.most_anisotropy
                                            : desc.vulkan.max_anisotropy,
                      .shader_float16 = device.float16};
    desc.ray_query = MASU_OFF; /* these GPUs use the built-in BVH */
    desc.debug.labels = 1;     /* names, from which rows get their pass */
    give_targets(&desc);
    if (!compile(&desc, error, error_size)) {
        masu_null_device_close(&device);
        return false;
    }
    if (rows->failed[0]) snprintf(error, error_size, "%s", rows->failed);
    return !rows->failed[0];
}

bool masu_isa_send(const masu_isa_rows *rows, FILE *f) {
    for (uint32_t i = 0; i < rows->count; i++) {
        const masu_isa_row *r = &rows->row[i];
        fprintf(f, "isa\t%s\t%s\t%u", r->pipeline, r->stage, r->lanes);
        for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++) fprintf(f, "\t%.9g", r->value[k]);
        fputc('\n', f);
    }
    return fflush(f) == 0;
}

/* Copies the text up to the next tab; returns the position after it, or NULL if there is no tab. */
static const char *take(const char *at, char out[MASU_ISA_TEXT]) {
    size_t n = strcspn(at, "\t\n");
    if (at[n] != '\t' || n >= MASU_ISA_TEXT) return NULL;
    memcpy(out, at, n);
    out[n] = 0;
    return at + n + 1;
}

static bool receive_row(const char *at, masu_isa_row *row) {
    char *end;
    if (!(at = take(at, row->pipeline)) || !(at = take(at, row->stage))) return false;
    row->lanes = (uint32_t)strtoul(at, &end, 10);
    for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++) {
        if (*end != '\t') return false;
        row->value[k] = strtod(end + 1, &end);
    }
    return *end == '\n';
}

bool masu_isa_receive(const char *text, masu_isa_rows *rows) {
    memset(rows, 0, sizeof *rows);
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL) {
        if (strncmp(line, "isa\t", 4)) continue;
        if (rows->count == MASU_ISA_ROWS || !receive_row(line + 4, &rows->row[rows->count]))
            return false;
        rows->count++;
    }
    return true;
}

bool masu_isa_is_printed(const char *line) { return strncmp(line, "SHADER-DB: ", 11) == 0; }

/* Reads the number before a given word. */
static double before_word(const char *line, const char *word) {
    const char *at = strstr(line, word);
    while (at && at > line && strchr("0123456789.", at[-1])) at--;
    return at ? strtod(at, NULL) : (double)NAN;
}

void masu_isa_read_printed(const char *line, masu_isa_row *row) {
    static const struct {
        const char *printed, *stage;
    } stages[] = {{"_VERTEX", "Vertex Shader"},
                  {"_POSITION", "Vertex Shader; position"},
                  {"_VARYING", "Vertex Shader; others"},
                  {"_FRAGMENT", "Fragment Shader"},
                  {"_COMPUTE", "Compute Shader"}};
    const char *stage = "(no stage)", *spills = strstr(line, " loops, ");
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++)
        if (strstr(line, stages[i].printed)) stage = stages[i].stage;
    snprintf(row->stage, sizeof row->stage, "%s", stage);
    row->value[MASU_ISA_WAVES] = before_word(line, " threads");
    row->value[MASU_ISA_INSTRUCTIONS] = before_word(line, " inst,");
    row->value[MASU_ISA_CYCLES] = before_word(line, " cycles");
    if (!spills) return;
    char *end;
    row->value[MASU_ISA_SPILLS] = strtod(spills + 8, &end);
    if (*end == ':') row->value[MASU_ISA_FILLS] = strtod(end + 1, NULL);
}
