#!/bin/sh
# The unit tests pass with the address and the undefined-behaviour sanitizer.
set -e
unset BUILD
make --no-print-directory -j"$(nproc)" config=sanitize WERROR=1 FULL= NESTED=1 unit
