#!/usr/bin/env bash
# Measures the trade of every scene of the gallery: tables into docs/measured and from there into
# docs/gallery.md, pictures into docs/pictures, everything into results/gallery. What is finished there is not run again: remove it for new measurements.
#
#   scripts/gallery.sh               # all; names of scenes as arguments: those
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
source scripts/measured.sh
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
  "gallery/wind-turbine-blade --families clamped-free,orthogonal-polynomials,vibration-modes --modes 2,3,4,6 --formulations ruthless,linear,consistent,quadratic"
  "solar-panel"
  "spacecraft --modes 1,2"
  "gallery/manipulator --modes 1,2"
  "gallery/flexible-pendulum"
  "gallery/long-chain --modes 1,2"
)

# rows FOLDER: trade.csv as rows of cells: every point of dopri5, of others those on the front. In bold: the front.
rows() {
  awk -F, '
    function cell(x) { return x == "" ? "–" : sprintf("%.3g", x) }
    NR == 1 { next }
    $4 != "dopri5" && $14 != 1 { next }
    { gsub(/"/, "", $6)
      row = ($14 == 1 ? "**" $1 "**" : $1) "\t" $2 ($3 == "" ? "" : " " $3) "\t" $6 "\t" $4 "\t"
      row = row ($7 != "completed" ? $7 "\t\t\t\t" : cell($8) "\t" cell(1000 * $9) "\t" cell(100 * $10) "\t" $11 "\t" cell(1000 * $13))
      if ($6 == "") sub(/\t\t/, "\t", row)
      over = over || $6 != ""
      rows[++n] = row }
    END {
      print "formulation\tmodes\t" (over ? "over\t" : "") "integrator\thinge error\ttip error [mm]\terror [%]\tsteps\tCPU [ms]"
      for (i = 1; i <= n; ++i) print rows[i] }' "$1/trade.csv"
}

for entry in "${gallery[@]}"; do
  read -r -a words <<<"$entry"
  scene=${words[0]} name=${words[0]##*/}
  [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
  folder=results/gallery/$name
  mkdir -p "$folder"
  echo "$name"
  command=(withy trade "scenes/$scene.yaml" --tolerances 1e-4 "${words[@]:1}")
  "build/release/bin/${command[0]}" "${command[@]:1}" --out "$folder" >"$folder.txt"
  cp "$folder/trade.svg" "docs/pictures/trade-$name.svg"
  rows "$folder" | record_table "trade-$name" "${command[*]}" "$(sed -n '/^Reference/p' "$folder.txt")"
done
scripts/docs.sh
