#!/usr/bin/env bash
# generate.sh PROTOC PLUGIN PROTO SOURCE OUT: makes the package in the folder OUT, of the files in SOURCE and of the
# messages and stubs that protoc generates from the contract in PROTO.
set -euo pipefail
protoc=$1 plugin=$2 proto=$3 source=$4 out=${5:?generate.sh PROTOC PLUGIN PROTO SOURCE OUT}
rm -rf "$out"
mkdir -p "$out"
cp -r "$source/pyproject.toml" "$source/graspdb" "$out"
find "$out" -name __pycache__ -prune -exec rm -r {} +
cd "$proto"
"$protoc" -I . --python_out="$out" --pyi_out="$out" google/rpc/*.proto graspdb/v1/*.proto
"$protoc" -I . --grpc_out="$out" --plugin=protoc-gen-grpc="$plugin" graspdb/v1/*_service.proto
# See graspdb/_rpc/__init__.py.
mv "$out"/google/rpc/* "$out/graspdb/_rpc"
rm -r "$out/google"
sed -i 's/^from google\.rpc import /from graspdb._rpc import /' "$out"/graspdb/v1/*_pb2*.py*
