#!/usr/bin/env bash
# auto.sh [BUILD]: measures what formulation `auto` holds and costs on the gallery, for docs/validity.md.
# BUILD: build/release, else the folder given.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
build=${1:-build/release}
rows=$(WITHY_TEST_SEEDS=20 "$build/bin/test-auto-campaign" | sed -n -e 's/^row\t//p' -e 's/^cost at most/&/p')
summary=$(sed -n '/^cost at most/p' <<<"$rows")
{
  printf 'scene\tsays\ttrue error\testimated\tcost\tcheapest\tran\n'
  sed '/^cost at most/d' <<<"$rows"
} | record_table auto "scripts/auto.sh" "Errors are in units of what was asked, 1 % of each output's own range, against the highest formulation on offer at 1e-9. Cost is evaluations times what one takes in its formulation and integrator, coarse runs included, over that of the cheapest single formulation that holds the accuracy: ${summary#cost }. The first 13 scenes were there when the choice was tuned, the last seven were not."
scripts/docs.sh
