#!/usr/bin/env bash
# Builds the program and simulates one heart beat of the built-in patient: out/demo/movie.mp4 and the files beside it.
set -eu
cd "$(dirname "$0")"
. ./setup.sh
configure_and_build
exec ./build/cusp demo -o out/demo "$@"
