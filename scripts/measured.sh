# Sourced: record_table NAME COMMAND [SENTENCE] writes docs/measured/NAME.txt from rows on standard input, cells between
# tabs, heads first. The commit is that of the sources, marked where they are changed; the machine is its processor.
# shellcheck shell=bash
record_table() {
  local commit
  commit=$(git rev-parse --short HEAD)
  git diff --quiet HEAD -- ':!docs' || commit+=" with changes"
  local machine
  machine=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -1)
  mkdir -p docs/measured
  {
    printf 'command: %s\ncommit: %s\nmachine: %s\ndate: %s\n\n' "$2" "$commit" "${machine:-$(uname -m)}" "$(date +%Y-%m-%d)"
    cat
    [ -z "${3:-}" ] || printf '\n%s\n' "$3"
  } >"docs/measured/$1.txt"
}
