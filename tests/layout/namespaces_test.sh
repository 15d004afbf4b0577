#!/usr/bin/env bash
# namespaces_test.sh SOURCE: whether the names of each source are in the namespace of its first folder, recognition/points in
# graspdb::recognition, or in one that its folder adds to it (recognition/simd in graspdb::recognition::simd); those of program
# are in graspdb itself.
set -euo pipefail
cd "$1"

failed=0
for folder in recognition storage program server files rendering pictures client console lab; do
  own=graspdb::$folder
  [ "$folder" != program ] || own=graspdb
  # FILE:NAMESPACE of all that are not those of a library; FILE:none of a header without one.
  while IFS=: read -r file namespace; do
    case $namespace in
      "$own") continue ;;
      "$own"::*) [ "$folder" = program ] || continue ;;
    esac
    echo "$file: the namespace is $namespace instead of $own"
    failed=1
  done < <(
    grep -rHoE '^(inline )?namespace graspdb[a-z_:]*' --include='*.h' --include='*.cc' "$folder" |
      sed -E 's/:(inline )?namespace /:/' | sort -u
    grep -rL '^namespace graspdb' --include='*.h' "$folder" | sed 's/$/:none/'
  )
done
exit $failed
