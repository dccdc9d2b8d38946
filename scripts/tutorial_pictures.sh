#!/usr/bin/env bash
# Makes the pictures of docs/tutorial.md: writes the page's scenes, runs its commands, and takes pictures of the pages
# that they leave with a browser.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}" chromium
build release withy

root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$root/scenes" "$work/scenes"
python3 - "$root/docs/tutorial.md" "$work" <<'PY'
import pathlib, re, sys
page, work = pathlib.Path(sys.argv[1]).read_text(), pathlib.Path(sys.argv[2])
commands = []
for language, text in re.findall(r"^```(\w+)\n(.*?)^```", page, re.M | re.S):
    if language == "yaml":
        (work / text[2:text.index("\n")]).write_text(text)
    elif language == "sh":
        commands.append(text)
(work / "commands.sh").write_text("".join(commands))
PY
(cd "$work" && PATH=$root/build/release/bin:$PATH bash -e commands.sh >commands.log)
(cd "$work" && "$root/build/release/bin/withy" plot results/pendulum-quadratic pivot --out pendulum.svg)
cp "$work/pendulum.svg" docs/pictures/tutorial-pendulum.svg
cp "$work/booms.svg" docs/pictures/tutorial-booms.svg
cp "$work/imager.svg" docs/pictures/tutorial-imager-loads.svg

# shot PAGE PICTURE HEIGHT: a page as it stands a second after it is opened.
shot() {
  chromium --headless --no-sandbox --hide-scrollbars --enable-unsafe-swiftshader --virtual-time-budget=4000 \
    --window-size="1200,$3" --screenshot="$root/docs/pictures/$2" "file://$work/$1" 2>"$work/browser.log"
}
shot results/satellite/report.html tutorial-satellite.png 760
shot results/modes/report.html tutorial-modes.png 620
shot results/tolerances/report.html tutorial-tolerances.png 760
shot results/imager-advice/report.html tutorial-imager-advice.png 1120
