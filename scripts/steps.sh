# What the scripts in this folder share; sourced from the root of the tree. Progress goes to stderr.

started=$SECONDS
if [ -t 2 ]; then bold=$'\e[1m' plain=$'\e[0m' clear=$'\r\e[K'; else bold='' plain='' clear=''; fi

# "[  12 s] words": what is being done.
say() { printf '%s%s[%4d s]%s %s\n' "$clear" "$bold" $((SECONDS - started)) "$plain" "$*" >&2; }
die() { say "$*"; exit 1; }

# Prints the comment at the head of the script, and ends it, where one of the arguments asks for help. For the first line of each
# script in this folder, so that nothing is installed or built before.
help_first() {
  local argument
  for argument in "$@"; do
    case $argument in
      -h | --help) awk 'NR > 1 && !/^#/ { exit } NR > 1 { sub(/^# ?/, ""); print }' "scripts/$(basename "$0")"; exit 0 ;;
    esac
  done
}

# One line that is written over again on a terminal; elsewhere a line only when `$1` (a percentage) passes a ten.
last_ten=-1
show_percent() {
  if [ -n "$clear" ]; then
    printf '%s[%4d s] %s' "$clear" $((SECONDS - started)) "$2" >&2
  elif [ $(($1 / 10)) -ne "$last_ten" ]; then
    last_ten=$(($1 / 10))
    printf '[%4d s] %s\n' $((SECONDS - started)) "$2" >&2
  fi
}

# Reads apt-get's output and shows how far it is.
show_apt_progress() {
  local line all=0 unpacked=0 configured=0
  while IFS= read -r line; do
    case $line in
      *"newly installed"*) all=$(sed -n 's/.* \([0-9]*\) newly installed.*/\1/p' <<<"$line") ;;
      "Need to get"*) say "packages: ${line%.}" ;;
      Unpacking*) unpacked=$((unpacked + 1)) ;;
      "Setting up"*) configured=$((configured + 1)) ;;
      *) continue ;;
    esac
    [ "${all:-0}" -eq 0 ] || show_percent $((50 * (unpacked + configured) / all)) \
      "packages: $unpacked of $all unpacked, $configured set up"
  done
  [ -z "$clear" ] || printf '%s' "$clear" >&2
}

# Reads ninja's output ("[12/345] Building …"); shows how far it is, and everything that is not a step.
show_ninja_progress() {
  local line
  while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (.*) ]]; then
      show_percent $((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) \
        "build: ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}  $(sed 's/.*\.dir\///; s/^Building CXX object //' <<<"${BASH_REMATCH[3]}" | cut -c1-80)"
    elif [ -n "$line" ] && [ "$line" != "ninja: no work to do." ]; then
      printf '%s%s\n' "$clear" "$line" >&2
    fi
  done
  [ -z "$clear" ] || printf '%s' "$clear" >&2
}

# build PRESET TARGET...: configures the preset if needed and builds the targets (all of them: "all"). cmake_options: what
# the preset leaves open, which one script sets as it needs it and the next one may want otherwise.
cmake_options=(-DDOCENT_BUILD_TESTS=ON -DDOCENT_BUILD_BENCH=ON)
build() {
  local preset=$1 log
  shift
  log=$(mktemp "${TMPDIR:-/tmp}/docent-cmake.XXXXXX")
  say "build: configuring preset $preset"
  cmake --preset "$preset" "${cmake_options[@]}" >"$log" 2>&1 || { cat "$log" >&2; die "cmake failed"; }
  rm -f "$log"
  say "build: $* (preset $preset, $(nproc) at a time)"
  ninja -C "build/$preset" "$@" 2>&1 | grep --line-buffered -v '^ninja: Entering' | show_ninja_progress || die "the build failed"
}

# Installs the packages of `$1`, a folder with a package.json, where they have changed, or `force` is 1.
npm_ci() {
  local folder=$1 log
  [ "${force:-0}" -eq 1 ] || ! [ "$folder/node_modules/.package-lock.json" -nt "$folder/package-lock.json" ] || return 0
  log=$(mktemp "${TMPDIR:-/tmp}/docent-npm.XXXXXX")
  say "web: installing the packages of $folder"
  (cd "$folder" && node "$(readlink -f "$(command -v npm)")" ci --no-audit --no-fund) >"$log" 2>&1 || { tail -n 20 "$log" >&2; die "npm ci failed"; }
  touch "$folder/node_modules/.package-lock.json"
  rm -f "$log"
}

# The tools of the browser app need node 20.19 or 22.12; an older one, as Debian 12 has, installs the one that web/node pins.
use_new_node() {
  local pinned
  ! node -e 'const [a, b] = process.versions.node.split(".").map(Number); process.exit(a > 22 || (a === 22 && b >= 12) || (a === 20 && b >= 19) ? 0 : 1)' 2>/dev/null || return 0
  npm_ci web/node
  pinned=(web/node/node_modules/node-linux-*/bin)
  [ -x "${pinned[0]}/node" ] || die "web: web/node has no node for this machine; install node 22.12 or newer"
  PATH=$PWD/${pinned[0]}:$PATH
  say "web: node $(node --version) of web/node, as the system's own is too old"
}
