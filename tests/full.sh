#!/bin/sh
# Every test once at full strength (TEST_MULT=1), with the counts that the random tests print.
# Optimised, since exact arithmetic is what takes the time. Takes long; one run is enough.
set -eu
cd "$(dirname "$0")/.."
export TEST_MULT="${TEST_MULT:-1}"
exec cargo test --release --no-fail-fast "$@" -- --nocapture
