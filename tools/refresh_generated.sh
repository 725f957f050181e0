#!/usr/bin/env bash
# Writes the generated files anew after option tables changed: configs/default.yaml and the tables of docs/configuration.md.
# Argument: the program (default build/release/bin/isthmus).
set -euo pipefail
cd "$(dirname "$0")/.."

isthmus=${1:-build/release/bin/isthmus}
"$isthmus" config default > configs/default.yaml.new
mv configs/default.yaml.new configs/default.yaml
page=docs/configuration.md
sed '/<!-- generated tables -->/q' "$page" > "$page.new"
echo >> "$page.new"
"$isthmus" config tables >> "$page.new"
mv "$page.new" "$page"
