# shellcheck shell=bash
# Slurm and munge, for the one command that tries studies in a queue (scripts/sweep.d/slurm-test). On Debian 13 they are the system's; for the private root
# they lie in a folder of their own beside it.

# chooseSlurm: sets slurm, the words before a program of Slurm or munge that is to run beside YADE, and slurmPlugins, the folder of its plugins. Needs chooseHost.
# shellcheck disable=SC2034 # for scripts/sweep.d/slurm-test
chooseSlurm() {
	slurmPlugins=/usr/lib/x86_64-linux-gnu/slurm-wlm
	if [[ $host == native ]]; then
		slurm="env"
		[[ -n $(PATH=$PATH:/usr/sbin command -v slurmctld) && -n $(PATH=$PATH:/usr/sbin command -v munged) ]] || die "there is no slurmctld or munged: the queue that is tried is Debian's Slurm." \
			"fix: apt-get install --no-install-recommends slurm-wlm munge"
	else
		local folder
		folder=$cache/slurm-$(rootHash)
		[[ -d $folder ]] || setUpSlurm "$folder"
		slurm=$folder/slurm
		slurmPlugins=$folder/tree$slurmPlugins
	fi
}

# setUpSlurm FOLDER: makes it.
setUpSlurm() {
	local name
	setUpBeside "$1" Slurm "4 MB" '^\(systemd\|libsystemd-shared\|mount\|ucf\|sensible-utils\|libtext-[a-z0-9-]*\)_' slurmctld slurmd slurm-client munge || return 0
	# what update-alternatives would have done
	for name in "$work"/tree/usr/sbin/*-wlm; do ln -s "${name##*/}" "${name%-wlm}"; done
	cat >"$work/slurm" <<-'END'
		#!/bin/bash
		# slurm PROGRAM ARGUMENTS
		here=$(dirname "$(readlink -f "$0")")/tree/usr
		export LD_LIBRARY_PATH=$here/lib/x86_64-linux-gnu:$here/lib/x86_64-linux-gnu/slurm-wlm PATH=$here/bin:$here/sbin:$PATH
		exec "$@"
	END
	finishBeside "$1" Slurm slurm slurmctld -V
}
