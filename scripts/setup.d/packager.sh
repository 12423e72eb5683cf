# shellcheck shell=bash
# Debian's packaging tools, for the one command that makes packages (scripts/package). On Debian 13 they are the system's; for the private root they lie in a
# folder of their own beside it and are laid over its /usr.

# choosePackager: sets the array packager, the words before a command that makes packages. Needs chooseHost.
# shellcheck disable=SC2034 # for scripts/package
choosePackager() {
	packager=(env)
	if [[ $host == native ]]; then
		[[ -n $(command -v dpkg-buildpackage) && -n $(command -v dh) ]] || die "there is no dpkg-buildpackage or dh in PATH." \
			"fix: apt-get install --no-install-recommends build-essential debhelper"
	else
		local folder
		folder=$cache/packager-$(rootHash)
		[[ -d $folder ]] || setUpPackager "$folder"
		layOver "$folder/tree/usr"
		# No package is installed in the root: dpkg's own list is an empty one.
		packager=("${over[@]}" --bind "$folder/dpkg" /var/lib/dpkg)
	fi
}

# layOver FOLDER: sets the array over, the words before a command that sees FOLDER laid over /usr and has no network, since YADE opens ports.
layOver() { over=(bwrap --bind / / --dev-bind /dev /dev --proc /proc --unshare-net --overlay-src /usr --overlay-src "$1" --ro-overlay /usr); }

# setUpPackager FOLDER: makes it.
setUpPackager() {
	setUpBeside "$1" "Debian's packaging tools" "20 MB" '^-' dpkg-dev debhelper gzip || return 0
	mkdir -p "$work"/dpkg/{info,updates}
	: >"$work/dpkg/status"
	cat >"$work/try" <<-'END'
		#!/bin/bash
		here=$(dirname "$(readlink -f "$0")")
		exec bwrap --bind / / --dev-bind /dev /dev --overlay-src /usr --overlay-src "$here/tree/usr" --ro-overlay /usr "$@"
	END
	finishBeside "$1" "Debian's packaging tools" try dpkg-buildpackage --version
}
