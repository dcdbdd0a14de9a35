/* driver_info.c: prints one line about the Vulkan driver that the loader finds first: device, name
 * of the driver, what it says of itself, version of Vulkan. Exit 1, with the reason, when there is
 * none. tests/run.sh asks it before it runs the GPU tests of a driver, so that a driver that does
 * not even load is one clear failure, not a hundred. */
#include <stdio.h>
#include <vulkan/vulkan.h>

int main(void) {
    VkApplicationInfo app = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .apiVersion = VK_API_VERSION_1_2,
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pApplicationInfo = &app,
    };
    VkInstance instance;
    VkResult result = vkCreateInstance(&info, NULL, &instance);
    if (result != VK_SUCCESS) {
        printf("vkCreateInstance: VkResult %d\n", (int)result);
        return 1;
    }

    VkPhysicalDevice device;
    uint32_t count = 1;
    result = vkEnumeratePhysicalDevices(instance, &count, &device);
    if (result < 0 || count == 0) {
        printf("no physical device (VkResult %d)\n", (int)result);
        vkDestroyInstance(instance, NULL);
        return 1;
    }

    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &driver,
    };
    vkGetPhysicalDeviceProperties2(device, &properties);
    uint32_t version = properties.properties.apiVersion;
    printf("%s, %s%s%s, Vulkan %u.%u.%u\n", properties.properties.deviceName, driver.driverName,
           driver.driverInfo[0] ? " " : "", driver.driverInfo, VK_API_VERSION_MAJOR(version),
           VK_API_VERSION_MINOR(version), VK_API_VERSION_PATCH(version));
    vkDestroyInstance(instance, NULL);
    return 0;
}
