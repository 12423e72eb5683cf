# shellcheck shell=bash
# LAMMPS, for the one benchmark that compares with it. On Debian 13 it is the system's; for the private root it lies in a folder of its own
# beside it, so that nobody else downloads it and the root stays as it is.

# chooseLammps: sets lammps, the program to run beside YADE. Needs chooseHost.
# shellcheck disable=SC2034 # for scripts/bench
chooseLammps() {
	if [[ $host == native ]]; then
		lammps=$(command -v lmp) || die "there is no lmp in PATH: the benchmark compares with Debian's LAMMPS." "fix: apt-get install --no-install-recommends lammps"
	else
		local folder
		folder=$cache/lammps-$(rootHash)
		[[ -d $folder ]] || setUpLammps "$folder"
		lammps=$folder/lmp
	fi
}

# setUpLammps FOLDER: what LAMMPS needs beyond the packages of the root, made under another name and renamed at the end.
setUpLammps() {
	local folder=$1 work=$1.part apt=$1.part/apt name size sum
	local packages names=() needed=()
	needAptTools
	lock 9 root
	if [[ -d $folder ]]; then # made by the run that was waited for
		exec 9>&-
		return
	fi
	removeTree "$work"
	mkdir -p "$work"/{tree,done}
	privateApt "$apt"
	listOf excludes >"$work/excludes"
	mapfile -t packages < <(listOf packages && listOf root-only)
	filesFor "$apt" "${packages[@]}" >"$work/root"
	filesFor "$apt" "${packages[@]}" lammps >"$work/both"
	# potentials of molecular dynamics are no use here
	mapfile -t needed < <(LC_ALL=C comm -13 "$work/root" "$work/both" | grep -v '^lammps-data_')
	((${#needed[@]})) || die "apt lists no package for LAMMPS." "the lists: $work/root, $work/both"
	for name in "${needed[@]}"; do names+=("${name%%_*}"); done
	say "downloading LAMMPS for this benchmark (${#names[@]} packages, about 10 MB)"
	(cd "$apt/cache/archives" && apt-get -q=2 download "${names[@]}") >"$apt/log" 2>&1 ||
		die "LAMMPS could not be downloaded: $(grep -E '^[EW]:' "$apt/log" | head -n 1)" "Run this again; the whole output: $apt/log"
	for name in "${needed[@]}"; do
		read -r name size sum <<<"$name"
		"$setupDir/unpack" "$work" "$name" "$size" "${sum#SHA256:}" || die "the package $name could not be unpacked." "Run this again."
	done
	cat >"$work/lmp" <<-'END'
		#!/bin/bash
		here=$(dirname "$(readlink -f "$0")")
		LD_LIBRARY_PATH=$here/tree/usr/lib/x86_64-linux-gnu exec "$here/tree/usr/bin/lmp" "$@"
	END
	chmod +x "$work/lmp"
	"${entry[@]}" "$work/lmp" -h >"$work/log" 2>&1 || die "LAMMPS does not start: $(tail -n 1 "$work/log")" "the whole output: $work/log"
	removeTree "$apt"
	unset APT_CONFIG
	mv -T "$work" "$folder"
	exec 9>&-
}

# filesFor APT PACKAGE...: a line 'file size SHA256:sum' for each package that these come with, sorted.
filesFor() {
	local apt=$1
	shift
	apt-get -q=2 -y --print-uris -o Dir::Cache::archives="$apt/none" install "$@" 2>"$apt/log" | sed -n "s/^'[^']*' //p" | LC_ALL=C sort ||
		die "apt cannot resolve the packages: $(grep -E '^[EW]:' "$apt/log" | head -n 1)" "the whole output: $apt/log"
}
