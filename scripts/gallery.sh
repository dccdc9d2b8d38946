#!/usr/bin/env bash
# Measures the trade of every scene of the gallery: tables into docs/trade.md, pictures into docs/pictures, everything
# into results/gallery. What is finished there is not run again: remove it for new measurements.
#
#   scripts/gallery.sh               # all; names of scenes as arguments: those
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build release withy

# Scene, then the options of withy trade that are its own.
gallery=(
  "two-link-slew"
  "extended-slew"
  "least-time-slew"
  "driven-arm"
  "gallery/spinning-beam --modes 1,2,4"
  "gallery/spinning-plate"
  "spin-up --modes 1,3 --over motions.spin.rate=1,2,4"
  "gallery/wind-turbine-blade --families clamped-free,orthogonal-polynomials --modes 2,4,6 --formulations ruthless,linear,consistent,quadratic"
  "solar-panel"
  "spacecraft --modes 1,2"
  "gallery/manipulator --modes 1,2"
  "gallery/flexible-pendulum"
  "gallery/long-chain --modes 1,2"
)

# table FOLDER: trade.csv as a table of Markdown: every point of dopri5, of others those on the front. In bold: the front.
table() {
  awk -F, '
    function cell(x) { return x == "" ? "–" : sprintf("%.3g", x) }
    NR == 1 { next }
    $4 != "dopri5" && $14 != 1 { next }
    { gsub(/"/, "", $6)
      row = "| " ($14 == 1 ? "**" $1 "**" : $1) " | " $2 ($3 == "" ? "" : " " $3) " | " $6 " | " $4 " | "
      row = row ($7 != "completed" ? $7 " | | | | |" : cell($8) " | " cell(1000 * $9) " | " cell(100 * $10) " | " $11 " | " cell(1000 * $13) " |")
      if ($6 == "") sub(/ \|  \| /, " | ", row)
      over = over || $6 != ""
      rows[++n] = row }
    END {
      print "| formulation | modes |" (over ? " over |" : "") " integrator | hinge error | tip error [mm] | error [%] | steps | CPU [ms] |"
      print "|---|---|---|---|---|---|---|---|" (over ? "---|" : "")
      for (i = 1; i <= n; ++i) print rows[i] }' "$1/trade.csv"
}

# replace NAME: standard input takes the place of what stands between the marks of NAME in docs/trade.md.
replace() {
  local text
  text=$(mktemp)
  awk -v name="$1" -v table="$(cat)" '
    $0 == "<!-- gallery: " name " -->" { print; print table; skip = 1; found = 1; next }
    $0 == "<!-- end -->" { skip = 0 }
    !skip { print }
    END { exit !found }' docs/trade.md >"$text" || {
    echo "docs/trade.md has no mark '<!-- gallery: $1 -->'" >&2
    exit 1
  }
  cat "$text" >docs/trade.md
  rm "$text"
}

for entry in "${gallery[@]}"; do
  read -r -a words <<<"$entry"
  scene=${words[0]} name=${words[0]##*/}
  [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
  folder=results/gallery/$name
  mkdir -p "$folder"
  echo "$name"
  build/release/bin/withy trade "scenes/$scene.yaml" --tolerances 1e-4 "${words[@]:1}" --out "$folder" >"$folder.txt"
  cp "$folder/trade.svg" "docs/pictures/trade-$name.svg"
  { table "$folder"; echo; sed -n '/^Reference/p' "$folder.txt"; } | replace "$name"
done
