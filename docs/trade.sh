#!/bin/sh
# Makes every picture and table of docs/trade.md anew: sh docs/trade.sh (some minutes).
set -eu
cd "$(dirname "$0")/.."
cargo build --release --quiet
trade() { ./target/release/snapfit trade "$@"; }
scenes="papers/donald-pai-1993/scenes examples"
trade $scenes --repeat 1 --format table --svg docs/trade-scatter.svg --out docs/trade-rates.txt
: > docs/trade-breakdown.txt
for family in strike race pass friction parallel; do
    trade --breakdown $family --every 50 --repeat 3 --format table --svg docs/trade-$family.svg >> docs/trade-breakdown.txt
done
trade --map papers/donald-pai-1993/scenes/fig15-diagonal.toml --format table \
    --svg docs/trade-map.svg --out docs/trade-map.txt
