#!/usr/bin/env bash
# Recipes of packages can be read by their tools, and name what the portable folder has.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0
complain() { echo "$*"; failed=1; }
id=org.marotte.Marotte
manifest=packaging/flatpak/$id.yml
for script in packaging/*/*.sh; do
    bash -n "$script" || complain "$script has a fault"
done
grep -q "^app-id: $id$" $manifest || complain "$manifest is of another program"
grep -q "^id=$id$" packaging/appimage/build.sh || complain "packaging/appimage/build.sh is of another program"
# The compilers of the portable folder see the packages that CONTRIBUTING.md names, so that none is forgotten there.
packages=$(sed -n '/^development=(/,/)/p; /^newer=(/p' packaging/portable/build.sh | grep -oE '\b[a-z0-9.+-]+-dev\b')
source_packages=$(grep -oE '\b[a-z0-9.+-]+-dev\b' .ci/setup.sh | sort -u)
for package in $packages; do
    case $package in libc6-dev | libstdc++-10-dev | libstb-dev) continue ;; esac
    grep -qx "$package" <<<"$source_packages" || complain "packaging/portable/build.sh: $package is not in .ci/setup.sh"
done
if command -v flatpak-builder >/dev/null; then
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    # A key that it does not know is a warning.
    if ! (cd "$scratch" && HOME=$scratch flatpak-builder --show-manifest "$SOURCE_DIR/$manifest" >/dev/null 2>"$scratch/said") ||
        [ -s "$scratch/said" ]; then
        complain "$manifest: $(cat "$scratch/said")"
    fi
elif [ $failed -eq 0 ]; then
    echo "SKIPPED: flatpak-builder is not installed, so $manifest was not parsed"
    exit 77
fi
exit $failed
