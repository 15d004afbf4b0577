#!/usr/bin/env bash
# fuzz.sh BUILD SECONDS TARGET...: runs fuzzers of a build folder, two at a time, each SECONDS long
# (0: the kept inputs alone), from the kept inputs and those of earlier runs. BUILD/corpus/TARGET
# grows; findings and logs are in BUILD/findings. Fails on any finding.
set -euo pipefail
build=$1 seconds=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$build/findings"

# A case that takes longer than this, s, or more memory, MiB, is a finding. The sanitizers make the
# code ten times slower and two to three times larger; two thirds of the time are a margin for busy
# machines.
max_seconds=30
max_memory=2048

# Maximum input length in bytes: for points the smallest scan that is segmented as a whole; for the
# others enough for every field of a file.
max_length() {
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
  "$build/bin/fuzz_$target" "${length[@]}" -max_len="$(max_length "$target")" \
    -timeout=$max_seconds -rss_limit_mb=$max_memory -print_final_stats=1 \
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
export build seconds here max_seconds max_memory
export -f run_one max_length
printf '%s\n' "$@" | xargs -P 2 -I{} bash -euo pipefail -c 'run_one {}'
