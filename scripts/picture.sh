#!/usr/bin/env bash
# Makes the picture at the head of the README: the two-link arm in the middle of a fast slew, and how far its tip is from
# that of exact kinematics, in four formulations; and the moving one below it, a strip swinging on a pin.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build release withy

build/release/bin/withy compare scenes/two-link-slew.yaml --formulations ruthless,inconsistent,consistent,quadratic \
  --reference exact --over loads.slew.time_scale=1.2 --set time.output=0.01 --out results/picture --force
# The first two panels.
sed -E '1s/height="[0-9.]+" viewBox="0 0 ([0-9.]+) [0-9.]+"/height="835" viewBox="0 0 \1 835"/' \
  results/picture/time_scale=1.2/compare.svg >docs/pictures/two-link-slew.svg

build/release/bin/withy compare scenes/gallery/flexible-pendulum.yaml --formulations ruthless,linear,quadratic,exact \
  --reference exact --set time.output=0.02 --out results/moving-picture --force
cp results/moving-picture/motion.svg docs/pictures/flexible-pendulum-motion.svg
