/* fuzz_machine.c: any bytes as machine.json in a folder of `masu bench`: read, appended to, merged with itself. What is
 * no list of runs is refused in a line and stays as it was; all texts that come out are ended. */
#include "in_file.h"

#include "bench/machine.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64], error[1024] = "";
    masu_machine machine = {.cpu = "cpu",
                            .driver = "driver",
                            .masu = "1.0.0",
                            .date = "2026-05-01 12:00 UTC",
                            .threads = 2},
                 out;
    in_file("machine.json", data, size, path);
    for (uint32_t i = 0; i < 4 && masu_machine_read(in_file_folder, i, &out); i++) {
        EXPECT(memchr(out.cpu, '\0', sizeof out.cpu) &&
               memchr(out.driver, '\0', sizeof out.driver));
        EXPECT(memchr(out.masu, '\0', sizeof out.masu) && memchr(out.date, '\0', sizeof out.date));
    }
    bool good = masu_machine_append(in_file_folder, &machine, error, sizeof error);
    EXPECT(good ? !*error : strstr(error, "machine.json") && !strchr(error, '\n'));
    EXPECT(good || in_file_is(path, data, size));
    uint32_t runs = 0;
    while (good && masu_machine_read(in_file_folder, runs, &out)) runs++;
    EXPECT(!good ||
           (runs && masu_machine_merge(in_file_folder, in_file_folder, error, sizeof error)));
    EXPECT(!good || !masu_machine_read(in_file_folder, runs, &out)); /* it has what it had */
    return 0;
}
