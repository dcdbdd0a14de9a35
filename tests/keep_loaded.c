/* keep_loaded.c: linked to whatever talks to a Vulkan driver when config=sanitize or thread. The
 * leak checker runs at exit and names the library that kept the memory; the loader has unloaded the
 * driver by then, and what drivers keep could no longer be told from what Masu keeps. So nothing is
 * unloaded; tests/lsan.supp then names the libraries. The thread sanitizer ends the program when a
 * library of tests/tsan.supp is unloaded. */
int dlclose(void *handle);

int dlclose(void *handle) {
    (void)handle;
    return 0;
}
