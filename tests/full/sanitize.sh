#!/bin/sh
# Everything builds with the other compiler, without a warning, and its unit tests pass with the address and
# the undefined-behaviour sanitizer. Shaders and scenes are those of the build that runs this. Reports name functions
# without line numbers (-g0 saves a sixth of the compile time); for lines, run the same test with
# `make CC=clang config=sanitize unit`.
set -e
command -v clang > /dev/null || exit 77
made=$MADE
unset BUILD MADE CC CXX
export ASAN_OPTIONS=${ASAN_OPTIONS:-handle_sigill=2} # undefined behaviour ends in a trap: with its function
export MASU_TEST_JOBS=$((($(nproc) + 1) / 2)) # of the others the tests beside it have use
make --no-print-directory -j"$MASU_TEST_JOBS" CC=clang config=sanitize CFLAGS=-g0 BUILD=build/clang \
    MADE="$made" WERROR=1 FULL= NESTED=1 unit
