/* fuzz_png.c: any bytes as a PNG file, with checksums made to fit, since a fuzzer will not guess those: what the
 * checks before the decoder let through must do the decoder no harm. */
#include "expect.h"

#include "image.h"

static uint32_t number(const uint8_t *p) {
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void mend_checksums(uint8_t *bytes, size_t count) {
    for (size_t at = 8; count - at >= 12 && number(bytes + at) <= count - at - 12;) {
        size_t n = number(bytes + at);
        uint32_t crc = 0xFFFFFFFFu;
        for (size_t i = 0; i < n + 4; i++) {
            crc ^= bytes[at + 4 + i];
            for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
        }
        for (int k = 0; k < 4; k++) bytes[at + 8 + n + (size_t)k] = (uint8_t)(~crc >> (24 - 8 * k));
        at += n + 12;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char error[1024] = "";
    uint32_t width = 0, height = 0;
    struct masu_image image;
    if (size < 20) return 0;
    uint8_t *bytes = malloc(size);
    EXPECT(bytes);
    memcpy(bytes, data, size);
    mend_checksums(bytes, size);
    /* Small ones alone: time is for what is in them. */
    if (size > 24 && (number(bytes + 16) > 1024 || number(bytes + 20) > 1024))
        memset(bytes + 16, 0, 6);
    mend_checksums(bytes, size);
    if (masu_image_decode_png("x.png", bytes, size, &image, error, sizeof error)) {
        EXPECT(image.width && image.height && image.rgba);
        masu_image_free(&image);
    } else {
        EXPECT(!strncmp(error, "x.png: ", 7) && !image.rgba);
    }
    uint16_t *gray =
        masu_image_decode_gray("x.png", bytes, size, &width, &height, error, sizeof error);
    EXPECT(!gray || (width && height));
    free(gray);
    free(bytes);
    return 0;
}
