#!/bin/sh
# Runs each libFuzzer target for some seconds, from its corpus. Usage: fuzz.sh BUILD SECONDS
set -eu
build=$1
seconds=$2
for target in "$build"/tests/fuzz/fuzz_*_live; do
    name=$(basename "$target" _live)
    found="$build/found/$name"
    corpus=${name#fuzz_}
    corpus="tests/fuzz/corpus/${corpus#mesh_}"
    mkdir -p "$found"
    echo "$name: $seconds s"
    "$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
        -artifact_prefix="$found/" "$found" "$corpus" 2>"$build/$name.log" || {
        tail -n 30 "$build/$name.log" >&2
        exit 1
    }
    grep -E 'stat::number_of_executed_units|cov:' "$build/$name.log" | tail -n 2
done
