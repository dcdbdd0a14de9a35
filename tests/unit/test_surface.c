/* test_surface.c: how examples/shared/surface.h handles surfaces that no test machine has: rotated
 * ones, and those without a UNORM format. */
#include "../../examples/shared/surface.h"

#include "support/support.h"

#define SRGB VK_COLOR_SPACE_SRGB_NONLINEAR_KHR

static void unorm_is_preferred_and_srgb_accepted(void **state) {
    (void)state;
    const VkSurfaceFormatKHR list[] = {{VK_FORMAT_B8G8R8A8_UNORM, VK_COLOR_SPACE_BT2020_LINEAR_EXT},
                                       {VK_FORMAT_R5G6B5_UNORM_PACK16, SRGB},
                                       {VK_FORMAT_R8G8B8A8_SRGB, SRGB},
                                       {VK_FORMAT_B8G8R8A8_SRGB, SRGB},
                                       {VK_FORMAT_R8G8B8A8_UNORM, SRGB}};
    assert_int_equal(surface_format(list, 5, false), VK_FORMAT_R8G8B8A8_UNORM);
    assert_int_equal(surface_format(list, 5, true), VK_FORMAT_B8G8R8A8_SRGB);
    assert_int_equal(surface_format(list, 4, false), VK_FORMAT_B8G8R8A8_SRGB); /* only sRGB */
    assert_int_equal(surface_format(list, 3, false), VK_FORMAT_R8G8B8A8_SRGB);
    assert_int_equal(surface_format(list + 4, 1, true), VK_FORMAT_R8G8B8A8_UNORM);
    assert_int_equal(surface_format(list, 2, false), VK_FORMAT_UNDEFINED);
    assert_int_equal(surface_format(list, 0, false), VK_FORMAT_UNDEFINED);
}

static void images_are_not_rotated_unless_they_must_be(void **state) {
    (void)state;
    VkSurfaceCapabilitiesKHR can = {.currentTransform = VK_SURFACE_TRANSFORM_ROTATE_90_BIT_KHR,
                                    .supportedTransforms = VK_SURFACE_TRANSFORM_ROTATE_90_BIT_KHR |
                                                           VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR};
    assert_int_equal(surface_transform(&can), VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR);
    can.supportedTransforms = VK_SURFACE_TRANSFORM_ROTATE_90_BIT_KHR;
    assert_int_equal(surface_transform(&can), VK_SURFACE_TRANSFORM_ROTATE_90_BIT_KHR);
}

static void fifo_paces_and_mailbox_does_not(void **state) {
    (void)state;
    const VkPresentModeKHR list[] = {VK_PRESENT_MODE_FIFO_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR,
                                     VK_PRESENT_MODE_MAILBOX_KHR};
    assert_int_equal(surface_mode(list, 3, true), VK_PRESENT_MODE_FIFO_KHR);
    assert_int_equal(surface_mode(list, 3, false), VK_PRESENT_MODE_MAILBOX_KHR);
    assert_int_equal(surface_mode(list, 2, false), VK_PRESENT_MODE_IMMEDIATE_KHR);
    assert_int_equal(surface_mode(list, 1, false), VK_PRESENT_MODE_FIFO_KHR);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unorm_is_preferred_and_srgb_accepted),
        cmocka_unit_test(images_are_not_rotated_unless_they_must_be),
        cmocka_unit_test(fifo_paces_and_mailbox_does_not),
    };
    return cmocka_run_group_tests_name("surface", tests, NULL, NULL);
}
