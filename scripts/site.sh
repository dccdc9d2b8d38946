#!/usr/bin/env bash
# Makes the pages of docs/ into a site, build/site/index.html: it opens from disk, search included. Pages that
# docs/site/index.md does not list stand under More; a picture or a link within the pages that leads nowhere is an error.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
need_packages "${build_packages[@]}" python3-sphinx python3-myst-parser doxygen
build release withy withy-python  # whose references are made from them

pages=build/site-pages
rm -rf "$pages" build/site build/reference
mkdir -p "$pages" build/reference
cp -r docs/*.md docs/decisions docs/pictures docs/site/* "$pages"
scripts/scene_reference.py build/release/bin/withy >"$pages/scene-reference.md"
# Links to files of the sources become their names: the site holds the pages alone.
python3 - "$pages" <<'PYTHON'
import pathlib, re, sys
root = pathlib.Path(sys.argv[1])
index = root / "index.md"
listed = index.read_text().split()
others = sorted(p.stem for p in root.glob("*.md") if p != index and p.stem not in listed)
if others:
    index.write_text(index.read_text() + "\n```{toctree}\n:caption: More\n" + "\n".join(others) + "\n```\n")
for page in root.rglob("*.md"):
    text = page.read_text()
    page.write_text(re.sub(r"\[([^\]]+)\]\((?:\.\./)+([^)#]+)(?:#[^)]*)?\)", lambda m: f"{m[1]} (`{m[2]}`)"
                           if not (page.parent / m[0].split("](")[1][:-1].split("#")[0]).exists() else m[0], text))
PYTHON
doxygen docs/reference/Doxyfile  # its warnings are errors
sphinx-build -q -W --keep-going -b html "$pages" build/site
chromium=$(command -v chromium || command -v chromium-browser || true)
if [ -n "$chromium" ] && [ -d web/node_modules ]; then node web/test/site_test.mjs build/site "$chromium"; fi
echo "build/site/index.html"
