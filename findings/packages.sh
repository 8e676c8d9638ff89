# Sourced by every script of this folder: a temporary folder, pinned packages unpacked into it, and a comparison.
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir -p "$root" "$work/archives/partial"

# debian PACKAGE=VERSION...: unpacks these packages, and what they need that this system lacks, below $root.
# Nothing is installed on the system. A version that the archive no longer has is an error of apt-get.
debian() {
  command -v apt-get >/dev/null || { echo "this script needs apt-get (Debian 12)"; exit 2; }
  apt-get -qq -y --no-install-recommends --download-only --reinstall -o Debug::NoLocking=1 \
    -o APT::Sandbox::User="$(id -un)" -o Dir::Cache::archives="$work/archives" install "$@" >/dev/null
  local package
  for package in "$work"/archives/*.deb; do dpkg-deb -x "$package" "$root"; done
  local settings=$root/usr/lib/R/etc/Renviron  # a link to /etc, which has none before R is installed
  [[ ! -e $settings.ucf ]] || cp --remove-destination "$settings.ucf" "$settings"
  LD_LIBRARY_PATH=$(find "$root" -name '*.so*' -printf '%h\n' | sort -u | paste -sd:)
  export LD_LIBRARY_PATH PATH=$root/usr/bin:$PATH
}

# compile SOURCE FLAGS...: builds $work/program against the headers and libraries below $root.
compile() {
  local source=$1 compiler=cc
  shift
  [[ $source == *.c ]] || compiler=c++
  "$compiler" -O1 -w -o "$work/program" "$source" -I"$root/usr/include" -I"$root/usr/include/eigen3" \
    -L"$root/usr/lib/x86_64-linux-gnu" "$@"
}

# expect TEXT COMMAND...: runs the command, prints what it prints, and fails unless that is TEXT.
expect() {
  local expected=$1 seen
  shift
  seen=$("$@")
  printf '%s\n' "$seen"
  [[ $seen == "$expected" ]] || { printf 'changed; this was seen before:\n%s\n' "$expected"; exit 1; }
}
