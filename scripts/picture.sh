#!/usr/bin/env bash
# Makes the picture at the head of the README: the two-link arm in the middle of a fast slew, and how far its tip is from
# that of exact kinematics, in four formulations.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build release withy

build/release/bin/withy compare scenes/two-link-slew.yaml --formulations ruthless,inconsistent,consistent,quadratic \
  --reference exact --over loads.slew.time_scale=1.2 --set time.output=0.01 --out results/picture --force
# The first two panels.
sed -E '1s/height="[0-9.]+" viewBox="0 0 ([0-9.]+) [0-9.]+"/height="835" viewBox="0 0 \1 835"/' \
  results/picture/time_scale=1.2/compare.svg >docs/pictures/two-link-slew.svg
