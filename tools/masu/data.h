/* data.h: the files that come with the program: suites, baked scenes. They lie beside it: below the folder
 * above its own, as `build/bin/masu` has build/suites, or as an installed PREFIX/bin/masu has
 * PREFIX/share/masu/suites. So they are found from any folder, and where the program is moved together
 * with them. */
#ifndef MASU_DATA_H
#define MASU_DATA_H

#include <stdbool.h>
#include <stddef.h>

#define MASU_DATA_PATH 4096

/* The folder of that kind, "suites" or "scenes". False: there is none, and `path` has what was looked
 * for: "A, B". */
bool masu_data_folder(const char *kind, char path[MASU_DATA_PATH]);

#endif
