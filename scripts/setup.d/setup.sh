# shellcheck shell=bash
# prepare TARGET...: does whatever set-up is still missing and builds in build/ (hexmembrane: the plugin alone; all: the tests and
# benchmarks too). Afterwards the array `entry` holds the words before a command that is to run beside YADE.
set -euo pipefail
# shellcheck source=scripts/setup.d/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
# shellcheck source=scripts/setup.d/apt.sh
. "$setupDir/apt.sh"
# shellcheck source=scripts/setup.d/root.sh
. "$setupDir/root.sh"
# shellcheck source=scripts/setup.d/native.sh
. "$setupDir/native.sh"
# shellcheck source=scripts/setup.d/beside.sh
. "$setupDir/beside.sh"
# shellcheck source=scripts/setup.d/lammps.sh
. "$setupDir/lammps.sh"
# shellcheck source=scripts/setup.d/browser.sh
. "$setupDir/browser.sh"
# shellcheck source=scripts/setup.d/slurm.sh
. "$setupDir/slurm.sh"
# shellcheck source=scripts/setup.d/packager.sh
. "$setupDir/packager.sh"

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
		requireEntry "${entry[@]}"
	fi
	entry+=(HEXMEMBRANE_BUILD="$buildDir")
}

# How many units are compiled at once: one takes up to 5.2 GB.
buildJobs() {
	local byMemory jobs
	byMemory=$(awk '/^MemTotal:/ { print int($2 / 5.2e6) }' /proc/meminfo)
	jobs=$(processors)
	((byMemory >= jobs)) || jobs=$((byMemory > 0 ? byMemory : 1))
	echo "$jobs"
}

# build FOLDER "TARGET..." OPTION...: builds the targets in FOLDER, configured with CMake's OPTIONs. ninja itself finds out what is out
# of date.
build() {
	local folder=$1 targets said
	read -ra targets <<<"$2"
	shift 2
	lock 8 "build-$(printf '%s' "$folder" | sha256sum | cut -c 1-12)"
	configure "$folder" "$@"
	said=$("${entry[@]}" ninja -C "$folder" build.ninja 2>&1) || die "cmake failed: $said"
	nameNoPlace "$folder"
	"${entry[@]}" ninja -C "$folder" -j "$(buildJobs)" "${targets[@]}" | tellBuild "$folder" || die "the build failed (see above)."
	exec 8>&-
}

# nameNoPlace FOLDER: ninja's commands for the checkout's sources without the checkout's place, so that a copied checkout compiles nothing anew.
nameNoPlace() {
	local place
	place=$(printf '%s' "$checkout" | sed 's/[][(){}.*+?^$|\\#]/\\&/g')
	! grep -Eq "^  INCLUDES = .*$place(/|[[:space:]]|\$)" "$1/build.ninja" || sed -E -i "/^  INCLUDES = |^build [^:]*\.o: /s#$place(/|[[:space:]]|\$)#..\1#g" "$1/build.ninja"
}

# configure FOLDER OPTION...: by CMake, when the host, the checkout's place or the options are not those of FOLDER's stamp. FOLDER is
# emptied then, so one without a stamp is refused: it is somebody's own. One of a copied checkout keeps what was compiled.
configure() {
	local folder=$1 stamp=$1/.host log=$1/configure.log wanted
	shift
	[[ ${CI:-} != true ]] || set -- "$@" -DHEXMEMBRANE_WERROR=ON
	wanted="$hostId $checkout $*"
	[[ ! -f $folder/build.ninja || $(cat "$stamp" 2>/dev/null) != "$wanted" ]] || return 0
	[[ -e $stamp || -z $(ls -A "$folder" 2>/dev/null) ]] || die "$folder: not made by scripts/, which would empty it." \
		"fix: remove or rename it; for builds of your own use another folder: cmake -B build-own ..."
	say "configuring ${folder##*/}/ ($hostId)"
	mkdir -p "$folder" || die "$checkout is not writable: there is no place for the build."
	if [[ $(cat "$stamp" 2>/dev/null) == "$hostId "*" $*" ]]; then # made for the same at another place
		rm -f "$folder/CMakeCache.txt"
	else
		echo unfinished >"$stamp"
		find "$folder" -mindepth 1 ! -path "$stamp" -delete
	fi
	"${entry[@]}" cmake -S "$checkout" -B "$folder" -G Ninja "$@" >"$log" 2>&1 || {
		cat "$log" >&2
		die "cmake failed (see above)."
	}
	echo "$wanted" >"$stamp"
}

# ninja's lines, once there is something to build. ninja says nothing before the first file is compiled, which may take a minute.
tellBuild() {
	local folder=$1 line building=0 status
	while :; do
		status=0
		IFS= read -r -t 2 line || status=$?
		((status == 0 || status > 128)) || break
		if ((status == 0)); then
			case $line in
			"ninja: Entering"* | "[0/"* | "ninja: no work"*) continue ;;
			esac
		fi
		((building)) || say "building in ${folder##*/}/ (the first time takes some minutes)"
		building=1
		((status)) || printf '%s\n' "$line" >&2
	done
}

prepare() {
	chooseHost
	build "$buildDir" "$*" -DCMAKE_BUILD_TYPE=Release -DYADE_EXECUTABLE=/usr/bin/yade-double -DYADE_SOURCE_DIR="$yadeSource"
}

# prepareForQueue TARGET...: prepare, for a command that may give jobs to a queue. What runs beside YADE finds the host's commands by the words in
# HEXMEMBRANE_ON_HOST, and a job that a queue has started on the host is beside YADE by those in HEXMEMBRANE_BESIDE; both are quoted for a shell.
prepareForQueue() {
	local onHost="" beside
	# shellcheck disable=SC2034 # for root.sh
	rootOptions=(--dev-bind / "$hostPlace")
	prepare "$@"
	[[ $host == native ]] || printf -v onHost '%q ' bwrap --dev-bind "$hostPlace" / /usr/bin/env PATH="$PATH" ${LD_LIBRARY_PATH:+LD_LIBRARY_PATH="$LD_LIBRARY_PATH"}
	printf -v beside '%q ' "${entry[@]}"
	entry+=(HEXMEMBRANE_ON_HOST="$onHost" HEXMEMBRANE_BESIDE="$beside")
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
		wait "$pid" 2>/dev/null || status=$?
		kill -0 "$pid" 2>/dev/null || break
	done
	exit "$status"
}

# runPython SCRIPT...: runBeside of launch.py or withoutPorts.py. They take on the signals that are blocked until then: Python would meet
# them with a traceback while it starts.
runPython() { runBeside env --block-signal=INT,TERM python3 "$@"; }

# Bubblewrap has exactly one child, the command; without it (natively) the process is the command itself.
# The command may end between the look and the signal: then there is nobody to tell, and the caller's wait gives its status.
terminate() {
	local target=$1
	[[ $host == native ]] || read -r target _ <"/proc/$1/task/$1/children" || true
	kill -TERM "${target:-$1}" 2>/dev/null || true
}
