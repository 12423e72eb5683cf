# shellcheck shell=bash
# Sourced first by the scripts: where things are, how they speak.

# A standard stream that is closed would give its place to the next file that is opened.
{ : <&0; } 2>/dev/null || exec </dev/null
{ : >&1; } 2>/dev/null || exec >/dev/null
{ : >&2; } 2>/dev/null || exec 2>/dev/null

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
setupDir=$checkout/scripts/setup.d
buildDir=$checkout/build

#: The YADE that this version of hexmembrane is made for, as Debian 13 has it.
yadeVersion=2025.2.0

# Progress goes to standard error: standard output belongs to what is run.
say() { printf 'hexmembrane [%4d s] %s\n' "$SECONDS" "$*" >&2; }

die() {
	printf 'hexmembrane: error: %s\n' "$1" >&2
	shift
	(($#)) && printf '  %s\n' "$@" >&2
	exit 1
}

if [[ -n ${XDG_CACHE_HOME:-} ]]; then
	cache=$XDG_CACHE_HOME/hexmembrane
elif [[ -n ${HOME:-} ]]; then
	cache=$HOME/.cache/hexmembrane
else
	die "neither HOME nor XDG_CACHE_HOME is set: there is no place for the cache folder." "fix: export XDG_CACHE_HOME=/some/folder"
fi
[[ $cache == /* ]] || die "XDG_CACHE_HOME = ${XDG_CACHE_HOME:-}: not an absolute path." "fix: give an absolute path, or unset it"

# The entries of a list file: no comments, no empty lines.
listOf() { sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' "$setupDir/$1.list"; }

# osField FILE FIELD: what a file like /etc/os-release says, empty when it says nothing.
osField() { [[ ! -r $1 ]] || sed -nE "s/^$2=[\"']?([^\"']*)[\"']?\$/\\1/p" "$1"; }

# Takes the lock named $2 on descriptor $1, waiting for another run that holds it. The descriptor is inherited on purpose: work
# that a killed run has left in the background keeps the lock until it has ended.
lock() {
	mkdir -p "$cache" || die "the cache folder $cache cannot be made." "fix: make its parent writable, or set XDG_CACHE_HOME"
	eval "exec $1>\"\$cache/\$2.lock\"" || die "the cache folder $cache is not writable." "fix: make it writable, or set XDG_CACHE_HOME"
	if ! flock -n "$1"; then
		say "another run is doing the same set-up; waiting for it"
		flock "$1"
	fi
}

processors() { nproc 2>/dev/null || echo 1; }
