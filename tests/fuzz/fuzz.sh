#!/usr/bin/env bash
# fuzz.sh BUILD SECONDS TARGET...: runs fuzzers of a build folder, two at a time, each SECONDS long,
# (0: the kept inputs alone) from the kept inputs and those of the runs before. BUILD/corpus/TARGET grows; what is found lies in
# BUILD/findings, and the log beside it. Fails when anything was found.
set -euo pipefail
build=$1 seconds=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$build/findings"

# A case that takes longer than this, s, or more memory, MiB, is a finding. The sanitizers make the
# code ten times slower and two to three times larger; two thirds of the time are left to machines
# that do something else as well.
slowest=30
most_memory=2048

# Inputs are no longer than this, in bytes: for points the smallest scan that is segmented as a
# whole; for the others what is long enough for all that a file may say.
longest() {
  case $1 in
    recognize | upload_views | catalogue) echo 65536 ;;
    point_file | depth_image | capture_set | storage_file | records) echo 16384 ;;
    *) echo 4096 ;;
  esac
}

run_one() {
  local target=$1 log=$build/findings/$1.log status=0
  mkdir -p "$build/corpus/$target"
  local length=(-max_total_time="$seconds")
  [ "$seconds" != 0 ] || length=(-runs=0)
  "$build/bin/fuzz_$target" "${length[@]}" -max_len="$(longest "$target")" \
    -timeout=$slowest -rss_limit_mb=$most_memory -print_final_stats=1 \
    -artifact_prefix="$build/findings/$target-" \
    "$build/corpus/$target" "$here/corpus/$target" >"$log" 2>&1 &
  local executions process=$!
  wait $process || status=$?
  # A process that ends by a signal leaves its files.
  rm -rf /dev/shm/graspdb_fuzz.$process.*
  executions=$(sed -n 's/^stat::number_of_executed_units: //p' "$log")
  printf '%-13s %10s executions, %s kept inputs\n' "$target" "${executions:-?}" \
    "$(find "$build/corpus/$target" -type f | wc -l)"
  [ $status = 0 ] && return
  printf '%s: found something (status %s), see %s\n' "$target" $status "$log" >&2
  grep -aE 'ERROR:|SUMMARY:|violated:|Test unit written' "$log" >&2 || tail -n 5 "$log" >&2
  return 1
}

export LSAN_OPTIONS="suppressions=$here/../sanitizers/lsan.txt print_suppressions=0 ${LSAN_OPTIONS:-}"
export build seconds here slowest most_memory
export -f run_one longest
printf '%s\n' "$@" | xargs -P 2 -I{} bash -euo pipefail -c 'run_one {}'
