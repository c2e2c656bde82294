#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs all libFuzzer targets one after the other, each for its share of SECONDS, from its seeds and the
# inputs found by earlier runs, and prints statistics. Fails if one of them crashed.
# Usage: fuzz.sh BUILD SECONDS
#
# Columns: inputs tried, total and per second; edges of the control flow reached in the whole library;
# lines reached in the target's own files, by its seeds and all found inputs. Growing corpora are kept
# in BUILD/found, crashes as BUILD/found/TARGET/crash-*.
set -eu
build=$1
seconds=$2
targets=$build/tests/fuzz/targets.txt
count=$(wc -l <"$targets")
share=$((seconds / count))
[ "$share" -gt 0 ] || share=1

# A number that libFuzzer printed at the end, or 0.
statistic() { # LOG NAME
    value=$(sed -n "s/^stat::$2: *//p" "$1" | tail -n 1)
    echo "${value:-0}"
}

edges() { # LOG
    value=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$1" | tail -n 1)
    echo "${value:-0}"
}

# The fraction of lines that the profile covers in the matching files.
lines() { # LIVE PROFILE FILES
    llvm-profdata merge -sparse "$2" -o "$2.merged"
    llvm-cov export -summary-only -instr-profile "$2.merged" "$1" |
        jq -r --arg files "/src/($3)\$" '[.data[0].files[] | select(.filename | test($files))
            | .summary.lines] | (map(.covered) | add // 0) as $c | (map(.count) | add // 0) as $n
            | if $n > 0 then "\(($c * 1000 / $n | round) / 10) %" else "-" end'
}

total=0
crashed=0
printf '| target | inputs | a second | edges | lines | crashes |\n|---|--:|--:|--:|--:|--:|\n'
while read -r name seeds files; do
    live=$build/tests/fuzz/${name}_live
    found=$build/found/$name
    log=$build/$name.log
    mkdir -p "$found/corpus"
    LLVM_PROFILE_FILE=/dev/null "$live" -max_total_time="$share" -timeout=60 -report_slow_units=60 -rss_limit_mb=2048 \
        -max_len=4096 -print_final_stats=1 -artifact_prefix="$found/" "$found/corpus" "$seeds" \
        >"$log" 2>&1 </dev/null || true
    LLVM_PROFILE_FILE=$log.profile "$live" -runs=0 "$found/corpus" "$seeds" >/dev/null 2>&1 \
        </dev/null || true
    crashes=$(find "$found" -maxdepth 1 -type f | wc -l)
    inputs=$(statistic "$log" number_of_executed_units)
    total=$((total + inputs))
    crashed=$((crashed + crashes))
    printf '| %s | %s | %s | %s | %s | %s |\n' "$name" "$inputs" \
        "$(statistic "$log" average_exec_per_sec)" "$(edges "$log")" \
        "$(lines "$live" "$log.profile" "$files")" "$crashes"
done <"$targets"
printf '| all | %s | | | | %s |\n' "$total" "$crashed"
if [ "$crashed" -gt 0 ]; then
    echo "fuzz: crashes found:" >&2
    find "$build/found" -maxdepth 2 -type f >&2
    exit 1
fi
