#!/bin/sh
# Everything builds with clang too, without a warning, and its unit tests pass.
set -e
command -v clang > /dev/null || exit 77
unset CC CXX
make --no-print-directory -j"$(nproc)" CC=clang BUILD=build/clang config=release WERROR=1 FULL= NESTED=1 unit
