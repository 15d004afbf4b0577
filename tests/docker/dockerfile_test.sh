#!/usr/bin/env bash
# dockerfile_test.sh SOURCE: checks that the images of docker/Dockerfile find what they are made of: all that
# cmake needs in the build context, and a package for each image. Builds nothing; CONTRIBUTING.md says how to.
set -euo pipefail
source=$1
context=$(mktemp -d)
trap 'rm -rf "$context"' EXIT

fail() {
  echo "docker/Dockerfile: $*" >&2
  exit 1
}

# The context as .dockerignore leaves it.
tar -C "$source" --exclude=.git --exclude=./build --exclude=node_modules -c . | tar -C "$context" -x
for excluded in build '**/node_modules' .git; do
  grep -qxF "$excluded" "$source/.dockerignore" || fail ".dockerignore does not leave out $excluded"
done
(cd "$context" && cmake --preset package) >"$context/log" 2>&1 || {
  cat "$context/log"
  fail "the context does not have all that cmake needs"
}

# Packages that cpack will make.
made=$(sed -n 's/^set(CPACK_DEBIAN_[A-Z]*_PACKAGE_NAME "\(.*\)")/\1/p' "$context/build/package/CPackConfig.cmake")
sed -n 's|^COPY --from=build /src/build/package/deb/\(.*\)_\*\.deb .*|\1|p' "$source/docker/Dockerfile" >"$context/used"
[ -s "$context/used" ] || fail "copies no package"
while read -r package; do
  grep -qxF "$package" <<<"$made" || fail "copies $package, which is none of the packages: $made"
done <"$context/used"
for target in $(sed -n 's/^FROM .* AS //p' "$source/docker/Dockerfile"); do
  [ "$target" = build ] || grep -q -- "--target $target " "$source/docker/Dockerfile" ||
    fail "does not explain how to build its target $target"
done
