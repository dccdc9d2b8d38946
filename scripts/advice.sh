#!/usr/bin/env bash
# advice.sh [FILE]: holds advice against exhaustive searches, on random scenes and on those that are shipped, for
# docs/advise.md: half an hour of one processor or more. FILE keeps a line a scene, and what it has is not measured again; default:
# results/advise.jsonl. A test fails where too many scenes have no advice: the table says how many.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
kept=${1:-results/advise.jsonl}
mkdir -p "$(dirname "$kept")"
campaign() { # SCENES AFTER COUNT
  WITHY_TEST_AFTER=$2 WITHY_TEST_SEEDS=$3 WITHY_TEST_FILE=$kept build/release/bin/test-campaigns --gtest_filter="AdviseCampaign.*$1*" || true
}
{
  printf 'scenes\tasked\tscenes asked for\tadvised\taccuracy met\tmost of it used\tcost at most 1.5 times the least\tthe same by CPU time\tworst cost\tleft out\n'
  {
    campaign least_cost 10800 60
    campaign shipped 0 72
  } | awk -F'\t' -v OFS='\t' '$1 == "row" { print $2, $3, $4, $5, $6, $7, $8, $9, $10, $12 }'
} | record_table advice-campaign scripts/advice.sh "Random scenes are those of seeds 10801 to 10860, none of which was looked at while the search was built; left out are those whose own run does not come to its end. Costs are evaluations times what one takes, over those of the cheapest candidate that passes."
scripts/docs.sh
