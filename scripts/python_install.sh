#!/usr/bin/env bash
# python_install.sh: times the way of a newcomer in Python on this machine, from a clone to the picture that docs/python.md
# begins with: a clone, a fresh virtual environment with Debian's NumPy and matplotlib, `pip install .` from nothing and
# without a network, the example of the page. Writes docs/measured/python-install.txt, for scripts/docs.sh.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
source scripts/measured.sh
need_packages "${build_packages[@]}" python3-venv python3-pip python3-matplotlib git
tree=$PWD

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Nothing is taken from the network: there is none.
offline=()
! unshare -rn true 2>/dev/null || offline=(unshare -rn)

TIMEFORMAT='%1R %1U %1S'
rows=$'step\twall [s]\tCPU [s]'
step() {
  local name=$1 seconds
  shift
  { seconds=$({ time "$@" >"$folder/log" 2>&1; } 2>&1); } || {
    tail -n 20 "$folder/log" >&2
    exit 1
  }
  rows+=$(awk -v name="$name" '{ printf "\n%s\t%.1f\t%.1f", name, $1, $2 + $3 }' <<<"$seconds")
  echo "$name: $seconds" >&2
}

step 'git clone' git clone -q . "$folder/withy"
# The first example of the page, as it stands there.
awk '/^```python$/ { on = 1; next } /^```$/ && on { exit } on' docs/python.md >"$folder/withy/boom.py"
cd "$folder/withy"
# Debian's interpreter, which has Debian's packages, whatever else stands first in the path.
step 'python3 -m venv --system-site-packages venv' /usr/bin/python3 -m venv --system-site-packages venv
step 'venv/bin/pip install .' "${offline[@]}" venv/bin/pip install --no-index .
step 'venv/bin/python boom.py' "${offline[@]}" venv/bin/python boom.py
[ -s tip.png ] || { echo "python_install.sh: the example has left no tip.png" >&2; exit 1; }
lines=$(grep -c . boom.py)
# As the clone's sources are: the tree may have gone on since.
printf '%s\n' "$rows" | record_table python-install scripts/python_install.sh \
  "From nothing, with $(nproc) cores, without a network; load $(cut -d' ' -f1 /proc/loadavg) at the end. The example has $lines lines."
cp docs/measured/python-install.txt "$tree/docs/measured/"
