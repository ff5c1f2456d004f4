#!/usr/bin/env bash
# Builds everything into build/ and runs all tests. On Debian it installs the packages that are missing (as root or with sudo).
set -eu
cd "$(dirname "$0")"
. ./setup.sh
configure_and_build
exec ctest --test-dir build -j2 --output-on-failure --no-tests=error
