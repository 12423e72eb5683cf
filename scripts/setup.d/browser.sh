# shellcheck shell=bash
# Chromium without a window, for what looks at reports as a reader does (scripts/test, scripts/report.d/look). On Debian 13 it is the system's; for the
# private root it lies in a folder of its own beside it.

# chooseBrowser: sets browser, the program to run beside YADE. Needs chooseHost.
# shellcheck disable=SC2034 # for scripts/test and scripts/report.d/look
chooseBrowser() {
	if [[ $host == native ]]; then
		if ((EUID == 0)) && [[ -z $(nativeBrowser) ]]; then installByApt chromium-headless-shell; fi
		browser=$(nativeBrowser)
		[[ $browser ]] || die "there is no chromium in PATH: reports are looked at with Debian's." \
			"fix: apt-get install --no-install-recommends chromium-headless-shell"
	else
		local folder
		folder=$cache/browser-$(rootHash)
		[[ -d $folder ]] || setUpBrowser "$folder"
		browser=$folder/chromium
	fi
}

# Its path, nothing without one: whoever asks says what is missing then.
nativeBrowser() { command -v chromium-headless-shell || command -v chromium || true; }

# setUpBrowser FOLDER: makes it.
setUpBrowser() {
	setUpBeside "$1" Chromium "105 MB" '^xdg-utils_' chromium-headless-shell || return 0
	cat >"$work/chromium" <<-'END'
		#!/bin/bash
		here=$(dirname "$(readlink -f "$0")")
		LD_LIBRARY_PATH=$here/tree/usr/lib/x86_64-linux-gnu:$here/tree/usr/lib/x86_64-linux-gnu/pulseaudio exec "$here/tree/usr/lib/chromium/chromium-headless-shell" "$@"
	END
	finishBeside "$1" Chromium chromium --version
}
