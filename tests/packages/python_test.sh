#!/usr/bin/env bash
# python_test.sh BUILD PROTO: the files of python3-graspdb alone work with Debian's Python, and beside the google.rpc of
# googleapis-common-protos, which is another one than ours.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cmake --install "$1" --component python --prefix "$folder/usr" >/dev/null
modules=$folder/usr/lib/python3/dist-packages
[ "$(ls "$modules")" = graspdb ]
[ -e "$modules/graspdb/py.typed" ] && [ -e "$folder/usr/share/doc/python3-graspdb/copyright" ]

python() { # FOLDER... -- CODE: with these folders of modules and Debian's
  local paths=()
  while [ "$1" != -- ]; do paths+=("$1") && shift; done
  printf 'import sys\nsys.path[:0] = "%s".split()\n%s' "${paths[*]}" "$2" | /usr/bin/python3 -I -B -
}

python "$modules" -- '
import graspdb
from graspdb.v1 import bundle_pb2, upload_service_pb2
for name in ("archive", "audit", "capture_set", "identity"):
    __import__(f"graspdb.v1.{name}_pb2")
assert graspdb.__file__.startswith(sys.path[0]), graspdb.__file__
upload_service_pb2.UploadView().error.code = 5
assert all(hasattr(graspdb, name) for name in graspdb.__all__)
graspdb.Client().close()
'

# Another text of the same files: with an option that ours does not have.
cp -r "$2/google" "$folder/google"
sed -i 's/^package google.rpc;/&\noption java_package = "com.google.rpc";/' "$folder"/google/rpc/*.proto
mkdir "$folder/other"
(cd "$folder" && protoc -I . --python_out=other google/rpc/*.proto)
for first in "import graspdb" "from google.rpc import status_pb2, error_details_pb2"; do
  python "$modules" "$folder/other" -- "
$first
import graspdb
from google.rpc import error_details_pb2, status_pb2
from graspdb.v1 import upload_service_pb2
view = upload_service_pb2.UploadView(error=status_pb2.Status(code=5))
view.error.details.add().Pack(error_details_pb2.ErrorInfo(reason='NO_CLUSTER'))
error = graspdb.errors.error_of_status(view.error)
assert error.reason is graspdb.Reason.NO_CLUSTER and isinstance(error, graspdb.errors.NotFound)
"
done
