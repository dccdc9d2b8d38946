#!/usr/bin/env bash
# docs.sh [--check]: puts the tables of docs/ in the place of what stands between `<!-- measured: NAME -->` and
# `<!-- end -->`, from the measurements in docs/measured/NAME.txt, and sources that tests build and run in the place of
# what stands after `<!-- source: PATH -->`. With --check nothing is written: a page that says something else than its
# measurements and sources, a mark without a file, a file of measurements that no page shows and a measured number that
# was typed by hand (scripts/typed_numbers.py) are errors.
#
# A file of measurements: lines `command: …`, `commit: …`, `machine: …`, `date: …`; an empty line; rows with tabs between their cells,
# the heads first; an empty line; sentences about them. scripts/gallery.sh writes those of the gallery, benchmarks.sh
# times, tolerances.sh and auto.sh what their names say, tables.py, import_tables.py and texts.py the rest; each with record_table of scripts/measured.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

check=${1:-}
[ -z "$check" ] || [ "$check" = --check ] || {
  echo "usage: scripts/docs.sh [--check]" >&2
  exit 2
}

# A file of measurements as Markdown, with what it comes from below.
markdown() {
  awk -F'\t' '
    part == 0 && /^[a-z]+: / { of[substr($0, 1, index($0, ":") - 1)] = substr($0, index($0, ":") + 2); next }
    /^$/ && part < 2 { part++; if (part == 1) next }
    part == 1 {
      row = "|"
      for (i = 1; i <= NF; ++i) row = row ($i == "" ? " |" : " " $i " |")
      print row
      if (!headed++) { rule = "|"; for (i = 1; i <= NF; ++i) rule = rule "---|"; print rule }
      next
    }
    { print }
    END {
      if (of["commit"] == "" || of["date"] == "" || of["command"] == "") exit 1
      on = of["machine"] == "" ? "" : " on " of["machine"]
      printf "\n<sub>`%s`, at %s%s, %s</sub>\n", of["command"], of["commit"], on, of["date"]
    }' "$1"
}

# A file of the sources as a block; nobody reads one of more than 150 lines.
shown_source() {
  [ -f "$1" ] && [ "$(wc -l <"$1")" -le 150 ] || return 1
  local language=${1##*.}
  case $language in hpp) language=cpp ;; txt) language=cmake ;; esac
  printf '```%s\n' "$language"
  cat "$1"
  printf '```\n'
}

bad=0
scripts/choosing.py $check || bad=1
[ -z "$check" ] || scripts/typed_numbers.py || bad=1
shown=" "
text=$(mktemp)
block=$(mktemp)
trap 'rm -f "$text" "$block"' EXIT
for page in docs/*.md; do
  marks=$(sed -n -E 's/^<!-- (measured: [a-z0-9-]*|source: [A-Za-z0-9_./-]*) -->$/\1/p' "$page")
  [ -n "$marks" ] || continue
  cp "$page" "$text"
  while read -r kind name; do
    if [ "$kind" = source: ]; then
      shown_source "$name" >"$block" || {
        echo "$page: there is no file $name of at most 150 lines" >&2
        bad=1
        continue
      }
    else
      shown+="$name "
      if ! markdown "docs/measured/$name.txt" >"$block"; then
        echo "$page: docs/measured/$name.txt is missing, or does not say its command, commit and date" >&2
        bad=1
        continue
      fi
    fi
    awk -v mark="<!-- $kind $name -->" -v block="$block" '
      $0 == mark { print; while ((getline line < block) > 0) print line; skip = 1; next }
      $0 == "<!-- end -->" { skip = 0 }
      !skip { print }' "$text" >"$text.new"
    mv "$text.new" "$text"
  done <<<"$marks"
  cmp -s "$text" "$page" && continue
  if [ -n "$check" ]; then
    diff --label "$page" --label "docs/measured" -u "$page" "$text" >&2 || true
    echo "$page does not say what was measured: run scripts/docs.sh" >&2
    bad=1
  else
    cat "$text" >"$page"
    echo "$page"
  fi
done
for file in docs/measured/*.txt; do
  name=$(basename "$file" .txt)
  [[ "$shown" == *" $name "* ]] || {
    echo "$file: no page shows it" >&2
    bad=1
  }
done
exit $bad
