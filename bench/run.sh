#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The figures of docs/BENCHMARKS.md. Usage: run.sh BUILD [DATA]
# DATA is the folder of models; without it the bundled samples are used.
set -eu
build=$1
data=${2:-../shared/data}
here=$(dirname "$0")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [ -d "$data/tosca_paper" ]; then
    models=$(ls "$data"/tosca_paper/*.off)
else
    echo "there is no $data: samples instead"
    models=""
    for name in horse human octopus; do
        "$build/starguard" sample $name --vertices 10000 -o "$work/$name.off" --quiet
        models="$models $work/$name.off"
    done
fi

echo "== queries per second"
sizes=""
for n in 10000 25000 100000 1000000; do
    "$build/starguard" sample horse --vertices $n -o "$work/horse_$n.off" --quiet
    sizes="$sizes $work/horse_$n.off"
done
# shellcheck disable=SC2086
"$build/bench/bench_visibility" 300 4 $models $sizes
# shellcheck disable=SC2086
"$build/bench/bench_region" 60 200 $models

echo "== guarding"
for method in greedy ilp "pilp --no-refine" pilp; do
    for m in $models; do
        # shellcheck disable=SC2086 # the method may contain an option
        /usr/bin/time -f '%e s elapsed, %U s user, %M KB' \
            "$build/starguard" guard "$m" -o "$work/g.json" --method $method --quiet 2>"$work/time"
        printf '%-16s %-30s %s: ' "$method" "$(basename "$m")" "$(tail -n 1 "$work/time")"
        python3 -c "import json,sys; g=json.load(open(sys.argv[1])); print(len(g['guards']), 'guards, bound', g['lower_bound'])" "$work/g.json"
        "$build/starguard" verify "$m" "$work/g.json" --quiet
    done
done

if [ -d "$data" ]; then
    for part in table1 "table1 --coverage 0.99" table2 figure1 figure2 growth; do
        echo "== the paper's $part"
        # shellcheck disable=SC2086 # the part may contain an option
        set -- $part
        command=$1
        shift
        python3 "$here/paper.py" "$command" "$build/starguard" "$data" "$@"
    done
fi

if [ -d "$data" ]; then
    echo "== every model"
    python3 "$here/survey.py" "$build/starguard" "$data"
fi
