# shellcheck shell=bash
# prepare [TARGET...]: does whatever set-up is still missing and builds (hexmembrane: the plugin alone; by default the tests and
# benchmarks too). Afterwards the array `entry` holds the words before a command that is to run beside YADE.
set -euo pipefail
# shellcheck source=/dev/null
for _part in common apt root native lammps; do . "$(dirname "${BASH_SOURCE[0]}")/$_part.sh"; done

# Where YADE comes from: sets host (native or root), yadeSource and entry.
chooseHost() {
	local wanted=${HEXMEMBRANE_HOST:-auto} installed
	[[ $wanted =~ ^(auto|native|root)$ ]] || die "HEXMEMBRANE_HOST = $wanted: must be native, root or auto."
	host=root
	if [[ $wanted != root ]] && isDebian13; then
		if ((EUID == 0)) || [[ -z $(missingPackages) ]]; then host=native; fi
	fi
	[[ $wanted != native || $host == native ]] ||
		die "HEXMEMBRANE_HOST = native: this is no Debian 13 with all of: $(listOf packages | tr '\n' ' ')" "fix: install them, or unset HEXMEMBRANE_HOST"
	if [[ $host == native ]]; then
		installPackages
		installed=$(dpkg-query -W -f '${Version}' yade)
		[[ $installed == "$yadeVersion"-* ]] || die "the installed yade is version $installed; hexmembrane supports Debian 13's $yadeVersion." \
			"fix: apt-get install yade=$yadeVersion-1+b1, or HEXMEMBRANE_HOST=root for a private root"
		yadeSource=$cache/yade-$yadeVersion
		[[ -d $yadeSource ]] || setUpNativeSource "$yadeSource"
		hostId="native $installed"
		entry=(env)
	else
		local root
		root=$cache/root-$(rootHash)
		local place
		for place in "$checkout" "$PWD" "$cache"; do
			case $place/ in
			/usr/* | /etc/* | /bin/* | /lib*/* | /sbin/* | /boot/*) die "$place cannot be seen from the private root, whose own /usr and /etc lie there." "fix: use a folder elsewhere" ;;
			esac
		done
		[[ -d $root ]] || setUpRoot "$root"
		unset APT_CONFIG
		yadeSource=/usr/src/yade
		hostId="root ${root##*-}"
		enterRoot "$root"
		"${entry[@]}" true 2>"$cache/enter.log" || dieWithoutNamespaces "$(tail -n 1 "$cache/enter.log")"
	fi
	entry+=(HEXMEMBRANE_BUILD="$buildDir")
}

# buildPlugin TARGET...: what is named of the build (everything: plugin, kernels' tests and benchmarks), in build/. ninja itself finds
# out what is out of date.
buildPlugin() {
	local stamp=$buildDir/.host jobs memoryGb log
	lock 8 "build-$(printf '%s' "$checkout" | sha256sum | cut -c 1-12)"
	if [[ -e $buildDir && ! -e $stamp ]]; then
		[[ ! -e $buildDir/CMakeCache.txt ]] || die "$buildDir was configured by hand; scripts/ would overwrite it." \
			"fix: remove it, or use another folder for builds of your own: cmake -B build-own ..."
	fi
	mkdir -p "$buildDir" || die "$checkout is not writable: there is no place for the build."
	log=$buildDir/configure.log
	if [[ ! -f $buildDir/build.ninja || $(cat "$stamp" 2>/dev/null) != "$hostId $checkout" ]]; then
		say "configuring the build ($hostId)"
		find "$buildDir" -mindepth 1 -delete
		echo unfinished >"$stamp"
		"${entry[@]}" cmake -S "$checkout" -B "$buildDir" -G Ninja -DCMAKE_BUILD_TYPE=Release -DYADE_EXECUTABLE=/usr/bin/yade-double \
			-DYADE_SOURCE_DIR="$yadeSource" >"$log" 2>&1 || {
			cat "$log" >&2
			die "cmake failed (see above)."
		}
		echo "$hostId $checkout" >"$stamp"
	fi
	# A unit of the plugin takes up to 5.2 GB to compile.
	memoryGb=$(awk '/^MemTotal:/ { print int($2 / 5.2e6) }' /proc/meminfo)
	jobs=$(processors)
	((memoryGb >= jobs)) || jobs=$((memoryGb > 0 ? memoryGb : 1))
	"${entry[@]}" ninja -C "$buildDir" -j "$jobs" "$@" | tellBuild || die "the build failed (see above)."
	exec 8>&-
}

# ninja's lines, once there is something to build. ninja says nothing before the first file is compiled, which may take a minute.
tellBuild() {
	local line building=0 status
	while :; do
		status=0
		IFS= read -r -t 2 line || status=$?
		((status == 0 || status > 128)) || break
		if ((status == 0)); then
			case $line in
			"ninja: Entering"* | "[0/"* | "ninja: no work"*) continue ;;
			esac
		fi
		((building)) || say "building the plugin (the first time takes some minutes)"
		building=1
		((status)) || printf '%s\n' "$line" >&2
	done
}

prepare() {
	chooseHost
	buildPlugin "$@"
}

# runBeside COMMAND...: runs COMMAND beside YADE as the last thing of this script, with its exit code. Signals must reach COMMAND, which
# has files to close, and nothing in between: bubblewrap would end at once and take COMMAND with it. So an interrupt from the terminal,
# which goes to all of them, is ignored on the way, and a termination is handed on. COMMAND does not outlive this script, but this
# script outlives the shell that has started it (nohup).
runBeside() {
	local pid status=0
	trap '' INT QUIT
	"${entry[@]}" env --default-signal=INT,QUIT PYTHONPATH="$checkout/py" "$@" <&0 &
	pid=$!
	trap 'terminate $pid' TERM
	while :; do
		status=0
		wait "$pid" || status=$?
		kill -0 "$pid" 2>/dev/null || break
	done
	exit "$status"
}

# Bubblewrap has exactly one child, the command; without it (natively) the process is the command itself.
terminate() {
	local target=$1
	[[ $host == native ]] || read -r target _ <"/proc/$1/task/$1/children" || true
	kill -TERM "${target:-$1}" 2>/dev/null || true
}
