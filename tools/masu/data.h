/* data.h: finds the files that belong to the program: suites, baked scenes. They are below the
 * parent of the program's folder: build/suites for `build/bin/masu`, PREFIX/share/masu/suites for
 * an installed PREFIX/bin/masu. So they are found from any folder, and if the program is moved
 * together with them. */
#ifndef MASU_DATA_H
#define MASU_DATA_H

#include <stdbool.h>
#include <stddef.h>

#define MASU_DATA_PATH 4096

/* The folder of that kind, "suites" or "scenes". On false there is none, and `path` holds the
 * searched folders: "A, B". */
bool masu_data_folder(const char *kind, char path[MASU_DATA_PATH]);

#endif
