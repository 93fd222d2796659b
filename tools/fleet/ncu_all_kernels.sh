#!/bin/bash
# A substitute for ncu, given to `ptbench inspect --counters` by PTBENCH_NCU: counts libraries' kernels as well, and
# does not flush caches, as in timed renders. NCU is the real ncu; FLEET_CSV-N.csv gets the N-th table.
#
#   PTBENCH_NCU=tools/fleet/ncu_all_kernels.sh NCU=$(which ncu) FLEET_CSV=out/queues \
#     build/ptbench inspect --counters --scene cornell_open --axis integrator=wavefront --out out/inspect_queues.json
#   python3 tools/fleet/merge_counters.py out > inspect_schedulers.json
set -u
args=() log=
while (($#)); do
  case "$1" in
    -k) shift 2 ;;
    --log-file)
      log=$2
      args+=("$1" "$2")
      shift 2
      ;;
    *)
      args+=("$1")
      shift
      ;;
  esac
done
"$NCU" --cache-control none "${args[@]}"
code=$?
number=$(cat "$FLEET_CSV.n" 2>/dev/null || echo 0)
echo $((number + 1)) >"$FLEET_CSV.n"
cp "$log" "$FLEET_CSV-$number.csv"
exit $code
