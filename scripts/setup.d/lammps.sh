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

# setUpLammps FOLDER: makes it. Potentials of molecular dynamics are no use here.
setUpLammps() {
	setUpBeside "$1" LAMMPS "10 MB" '^lammps-data_' lammps || return 0
	cat >"$work/lmp" <<-'END'
		#!/bin/bash
		here=$(dirname "$(readlink -f "$0")")
		LD_LIBRARY_PATH=$here/tree/usr/lib/x86_64-linux-gnu exec "$here/tree/usr/bin/lmp" "$@"
	END
	finishBeside "$1" LAMMPS lmp -h
}
