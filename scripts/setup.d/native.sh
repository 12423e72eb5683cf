# shellcheck shell=bash
# Debian 13 itself: YADE and the rest are the system's packages.

isDebian13() { [[ $(osField /etc/os-release ID) == debian && $(osField /etc/os-release VERSION_ID) == 13 ]]; }

# The packages of packages.list that are not installed.
missingPackages() {
	local packages
	mapfile -t packages < <(listOf packages)
	comm -23 <(printf '%s\n' "${packages[@]}" | sort) \
		<(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p' | sort -u)
}

# Installs what is missing; only root may.
installPackages() {
	local missing
	mapfile -t missing < <(missingPackages)
	((${#missing[@]})) || return 0
	installByApt "${missing[@]}"
}

# installByApt PACKAGE...: without what they recommend; only root may.
installByApt() {
	lock 9 root
	say "installing Debian packages: $*"
	{ apt-get -q update && DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends install "$@"; } >&2 ||
		die "Debian's packages could not be installed (see above)." "fix: check the network and /etc/apt/sources.list, then run this again"
	exec 9>&-
}

# Debian 13's YADE headers, in the cache folder.
setUpNativeSource() {
	local folder=$1 work=$1.part
	lock 9 root
	if [[ ! -d $folder ]]; then
		needAptTools
		removeTree "$work"
		privateApt "$work/apt"
		fetchYadeSource "$work/source"
		unpackYadeSource "$yadeTarball" "$work/tree" python3
		unset APT_CONFIG
		mv -T "$work/tree" "$folder"
		removeTree "$work"
	fi
	exec 9>&-
}
