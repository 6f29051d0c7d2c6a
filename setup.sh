#!/bin/sh
# Sets gaitlab up on Debian or Ubuntu and runs it:   sh setup.sh demo    sh setup.sh test    sh setup.sh run walk_ratio ...
# Everything goes into .venv beside this file; only missing system libraries are installed outside it.
set -eu
cd "$(dirname "$0")"

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; elif command -v sudo >/dev/null 2>&1; then sudo "$@"; else
    echo "setup.sh: $* needs an administrator; ask one to run it, then try again." >&2; exit 1; fi
}

apt_updated=no
install_packages() {
  if ! command -v apt-get >/dev/null 2>&1; then
    echo "setup.sh: please install with your system's package manager: $*" >&2; exit 1
  fi
  if [ $apt_updated = no ]; then as_root apt-get update -qq; apt_updated=yes; fi
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

has_library() { ldconfig -p 2>/dev/null | grep -q "$1" || /sbin/ldconfig -p 2>/dev/null | grep -q "$1"; }

find_python() {
  for name in python3.13 python3.12 python3.11 python3; do
    if command -v "$name" >/dev/null 2>&1 &&
      "$name" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
      command -v "$name"; return
    fi
  done
}

python=$(find_python)
if [ -z "$python" ]; then
  install_packages python3 python3-venv
  python=$(find_python)
  if [ -z "$python" ]; then install_packages python3.11 python3.11-venv; python=$(find_python); fi
fi

missing=""
has_library libEGL.so.1 || missing="$missing libegl1"
has_library libGL.so.1 || missing="$missing libgl1"
ls /usr/lib/*/dri/*_dri.so /usr/lib*/dri/*_dri.so /usr/lib/*/libgallium*.so >/dev/null 2>&1 || missing="$missing libgl1-mesa-dri"
has_library libfribidi.so.0 || missing="$missing libfribidi0"
for library in X11 X11-xcb Xcursor Xi Xinerama Xrandr Xxf86vm; do
  has_library "lib$library.so" || missing="$missing lib$(echo "$library" | tr '[:upper:]' '[:lower:]')"
done
missing=$(echo "$missing" | sed 's/libx11-xcb/libx11-xcb1/;s/libxcursor/libxcursor1/;s/libxinerama/libxinerama1/;s/libxi\( \|$\)/libxi6\1/;s/libxrandr/libxrandr2/;s/libxxf86vm/libxxf86vm1/;s/libx11\( \|$\)/libx11-6\1/')
if [ "${1:-}" = test ]; then
  command -v Xvfb >/dev/null 2>&1 || missing="$missing xvfb"
  command -v xdotool >/dev/null 2>&1 || missing="$missing xdotool"
  command -v glslangValidator >/dev/null 2>&1 || missing="$missing glslang-tools"
fi
# shellcheck disable=SC2086 - a list of packages
if [ -n "$missing" ]; then install_packages $missing; fi

lock=requirements.lock
if [ "${1:-}" = test ]; then lock=requirements-dev.lock; fi
stamp=.venv/.installed-$lock
[ -x .venv/bin/python ] || "$python" -m venv .venv
if [ ! -f "$stamp" ] || [ "$lock" -nt "$stamp" ] || [ pyproject.toml -nt "$stamp" ]; then
  echo "Installing gaitlab and its libraries into .venv ..." >&2
  .venv/bin/python -m pip install -q --disable-pip-version-check --no-deps --require-hashes -r "$lock"
  .venv/bin/python -m pip install -q --disable-pip-version-check --no-deps --no-build-isolation -e .
  touch "$stamp"
fi

if [ "${1:-}" = test ]; then
  shift
  exec .venv/bin/python -m tests.run "$@"
fi
exec .venv/bin/gaitlab "$@"
