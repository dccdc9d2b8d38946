#!/usr/bin/env bash
# Makes the picture at the head of the README: the two-link arm in the middle of a fast slew, and how far its tip is from
# that of exact kinematics, in four formulations; the moving one below it, a strip swinging on a pin; and those of
# docs/outputs.md, torques and load envelopes of the slew.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}"
build release withy

build/release/bin/withy compare scenes/two-link-slew.yaml --formulations ruthless,inconsistent,consistent,quadratic \
  --reference exact --over loads.slew.time_scale=1.2 --set time.output=0.01 \
  --set "name=one slew of a flexible arm, four linearizations against exact" --out results/picture --force
# The first two panels.
sed -E '1s/height="[0-9.]+" viewBox="0 0 ([0-9.]+) [0-9.]+"/height="835" viewBox="0 0 \1 835"/' \
  results/picture/time_scale=1.2/compare.svg >docs/pictures/two-link-slew.svg

build/release/bin/withy compare scenes/gallery/flexible-pendulum.yaml --formulations ruthless,linear,quadratic,exact \
  --reference exact --set time.output=0.02 --set time.end=4 --out results/moving-picture --force
# Twenty seconds for the four, the last 8 % of them at rest.
sed -e 's/dur="8s"/dur="20s"/g' -e 's/, at [0-9.]* of its speed/, at 0.22 of its speed/' \
  results/moving-picture/motion.svg >docs/pictures/flexible-pendulum-motion.svg

# Torques over time, as figure 4 of Padilla and von Flotow, and the greatest moments along link 1.
for scale in 1.0 1.2; do
  build/release/bin/withy run scenes/loads-of-the-slew.yaml --set loads.slew.time_scale=$scale \
    --out "results/slew, alpha = $scale" --force
done
build/release/bin/withy plot "results/slew, alpha = 1.0" shoulder_torque elbow_torque --out docs/pictures/slew-torques.svg
build/release/bin/withy plot "results/slew, alpha = 1.0" "results/slew, alpha = 1.2" root.mz inner.mz middle.mz outer.mz end.mz \
  --over 0,0.2286,0.4572,0.6858,0.9144 --out docs/pictures/slew-envelope.svg
