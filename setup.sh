# Sourced by test.sh and demo.sh: packages, configuration, build. Seconds when nothing changed.

# Says which of dependencies.txt are not installed and installs them; elsewhere than on Debian says what is needed.
install_missing_packages() {
  local wanted missing="" package
  wanted=$(grep -v '^#' dependencies.txt)
  if ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian: install the equivalents of these packages, then run again:" $wanted >&2
    command -v cmake >/dev/null && command -v ninja >/dev/null && return 0
    exit 2
  fi
  for package in $wanted; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "Installing:$missing"
  local as_root=""
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "These packages are missing:$missing; run as root, or install them: apt-get install$missing" >&2; exit 2; }
    as_root=sudo
  fi
  $as_root apt-get update -q
  DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -q --no-install-recommends $missing
}

configure_and_build() {
  install_missing_packages
  # ccache keeps a rebuild short; two compilers at a time per gigabyte and a half of memory
  local memory jobs
  memory=$(awk '/MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo 2>/dev/null || echo 2)
  jobs=$(nproc 2>/dev/null || echo 2)
  [ "$memory" -ge 1 ] || memory=1
  [ "$jobs" -le "$memory" ] || jobs=$memory
  [ -f build/build.ninja ] || cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release
  cmake --build build --parallel "$jobs"
}
