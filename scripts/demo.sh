#!/usr/bin/env bash
# Builds withy and shows the two-link arm of Padilla and von Flotow in four formulations at three speeds.
[ $# = 0 ] || {
  echo "usage: scripts/demo.sh" >&2
  exit 2
}
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
echo "Building (some minutes the first time) ..."
build release withy

echo
build/release/bin/withy compare scenes/two-link-slew.yaml \
  --formulations ruthless,inconsistent,consistent,quadratic \
  --over loads.slew.time_scale=0.1685,1.0,1.2 --set time.output=0.01 \
  --out results/demo
