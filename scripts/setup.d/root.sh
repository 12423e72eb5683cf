# shellcheck shell=bash
# The private Debian 13 root, for hosts that are no Debian 13 and for users who may not install packages. It is unpacked, not
# installed: no maintainer script runs, nothing needs privileges. Commands run in it through the kernel's namespaces (bubblewrap,
# started by the root's own loader), with the host's files at their usual places (enterRoot).

# Raised when the way the root is made changes, so that older ones are made anew.
rootRecipe=2

rootHash() { { echo "$rootRecipe $yadeVersion" && listOf packages && listOf root-only && listOf leftout && listOf excludes; } | sha256sum | cut -c 1-12; }

# Removes a tree that packages were unpacked into: some of their folders may not be writable.
removeTree() {
	[[ -e $1 ]] || return 0
	# what chmod cannot open, rm reports: its error is the one to see
	chmod -R u+rwX "$1" 2>/dev/null || true
	rm -rf "$1"
}

# Why the kernel refuses namespaces, tried before anything is downloaded; prints nothing when they work.
namespaceTrouble() {
	local try=(unshare --mount) out
	((EUID == 0)) || try=(unshare --user --map-root-user --mount)
	command -v unshare >/dev/null || return 0
	out=$("${try[@]}" mount -t tmpfs none /tmp 2>&1) || echo "${out:-refused}"
}

dieWithoutNamespaces() {
	local hint="fix: kernel.unprivileged_userns_clone=1, user.max_user_namespaces above 0, kernel.apparmor_restrict_unprivileged_userns=0 (sysctl)"
	((EUID != 0)) || hint="fix: in a container, start it with --privileged (or --cap-add SYS_ADMIN --security-opt seccomp=unconfined --security-opt apparmor=unconfined)"
	die "the private Debian 13 root cannot be entered: this kernel or container refuses mount namespaces ($1)." "$hint" \
		"Or use Debian 13 itself (e.g. the image debian:13), where no private root is needed."
}

# requireEntry ENTRY...: the root can be entered by these words. What they say is held in memory: the cache may be read-only.
requireEntry() {
	local said
	said=$("$@" true 2>&1) || dieWithoutNamespaces "$(tail -n 1 <<<"$said")"
}

# requirePlain FOLDER: its name can stand in apt's configuration and in the loader's list of folders.
requirePlain() {
	local odd
	for odd in : '"' '\' $'\n'; do
		[[ $1 != *"$odd"* ]] || die "the cache folder $1 has the character $odd in its name, which apt or the loader takes for their own." \
			"fix: set XDG_CACHE_HOME to a folder without it"
	done
}

#: Where the host's own / is seen in the root, for a command that asks for it (rootOptions), and further options of bubblewrap.
hostPlace=/host-of-hexmembrane
rootOptions=()

# enterRoot TREE: sets the array `entry`, the words before a command that is to run in TREE. /usr and /etc are the root's, read-only;
# every other top-level folder is the host's at the same path: checkout, cache, home, output and working folder need no translation.
enterRoot() {
	local tree=$1 path
	local loader=$tree/usr/lib64/ld-linux-x86-64.so.2
	entry=("$loader" --library-path "$tree/usr/lib/x86_64-linux-gnu" "$tree/usr/bin/bwrap" --die-with-parent)
	entry+=(--ro-bind "$tree/usr" /usr --symlink usr/bin /bin --symlink usr/sbin /sbin --symlink usr/lib /lib --symlink usr/lib64 /lib64)
	entry+=(--ro-bind "$tree/etc" /etc)
	for path in /etc/passwd /etc/group /etc/hosts /etc/resolv.conf /etc/localtime; do
		if [[ -f $path && -e $tree$path ]]; then entry+=(--ro-bind "$path" "$path"); fi
	done
	for path in /*; do
		case $path in
		/bin | /sbin | /lib* | /usr | /etc | /boot | /lost+found | "$hostPlace") ;;
		/dev) entry+=(--dev-bind /dev /dev) ;;
		*)
			if [[ -L $path ]]; then
				entry+=(--symlink "$(readlink "$path")" "$path")
			elif [[ -d $path ]]; then
				entry+=(--bind "$path" "$path")
			fi
			;;
		esac
	done
	entry+=("${rootOptions[@]}" --chdir "$PWD")
	entry+=(/usr/bin/env -u LD_LIBRARY_PATH -u LD_PRELOAD -u PYTHONHOME -u PYTHONPATH -u PYTHONDONTWRITEBYTECODE -u BASH_ENV PATH=/usr/bin:/usr/sbin LC_ALL=C.UTF-8)
	# Byte code beside the cache, since the root is read-only: without it each start compiles Python's packages anew, 2.5 s. Who keeps Python from writing it
	# beside his sources is not met there. No packages of the host's Python.
	entry+=(PYTHONPYCACHEPREFIX="$cache/bytecode" PYTHONNOUSERSITE=1)
}

# setUpRoot ROOT: makes the root, unless it is complete. It is made under another name and renamed at the end, so a root that has its
# name is a whole one; what a killed run has left is used for the download only, where every file is checked again.
setUpRoot() {
	local root=$1 work=$1.part trouble
	[[ $(uname -m) == x86_64 ]] || die "this machine is $(uname -m); the private Debian 13 root is made for x86_64 only." \
		"On Debian 13 itself install the packages of scripts/setup.d/packages.list; then no private root is needed."
	requirePlain "$cache"
	needAptTools
	trouble=$(namespaceTrouble)
	[[ -z $trouble ]] || dieWithoutNamespaces "$trouble"
	lock 9 root
	if [[ -d $root ]]; then # made by the run that was waited for
		exec 9>&-
		return
	fi
	say "first set-up: a private Debian 13 root with YADE, compiler and libraries (about 560 MB to download, 2.1 GB on disk)"
	say "in $root"
	local freeKb
	freeKb=$(df -Pk "$cache" | awk 'NR == 2 { print $4 }')
	((freeKb > 3200000)) || die "$cache has $((freeKb / 1000)) MB left; the set-up needs 3200 MB." "fix: free space, or set XDG_CACHE_HOME"
	removeTree "$work/tree"
	removeTree "$work/done"
	mkdir -p "$work"/{tree,done}
	privateApt "$work/apt"
	unpackPackages "$work"
	finishRoot "$work"
	mv -T "$work/tree" "$root"
	removeTree "$work"
	exec 9>&-
	say "the root is ready ($(du -sm "$root" | cut -f 1) MB)"
	local other
	for other in "$cache"/root-*; do
		[[ $other == "$root" || ! -d $other ]] || say "note: $other is of another version of hexmembrane; remove it when no checkout uses it"
	done
}

# Download and unpacking side by side: the one waits for the network, the other for the processors.
unpackPackages() {
	local work=$1 apt=$1/apt name size sum total=0 count=0 ready=() packages
	declare -A sizes sums
	mapfile -t packages < <(listOf packages && listOf root-only)
	listOf excludes >"$work/excludes"
	apt-get -q=2 -y --print-uris -o Dir::Cache::archives="$apt/none" install "${packages[@]}" >"$work/wanted" 2>"$apt/log" ||
		die "apt cannot resolve the packages: $(grep -E '^[EW]:' "$apt/log" | head -n 1)" "the whole output: $apt/log"
	while read -r _ name size sum; do
		[[ $sum == SHA256:* ]] || die "the archive's index has no SHA256 sum for $name."
		sizes[$name]=$size sums[$name]=${sum#SHA256:}
		((total += size, count += 1))
	done < <(grep "^'" "$work/wanted")
	((count > 100)) || die "apt lists only $count packages for the root." "the list: $work/wanted"
	say "downloading and unpacking $count packages ($((total / 1000000)) MB)"
	apt-get -q=2 -y --download-only install "${packages[@]}" >"$apt/log" 2>&1 &
	local apt_pid=$! running=1 told=$SECONDS
	# At the end apt-get has finished and there is nobody to kill: no error. Expanded now: apt_pid is local.
	# shellcheck disable=SC2064
	trap "kill $apt_pid 2>/dev/null || true" EXIT
	# Links that packages with old paths must find: /lib/... lies in /usr/lib/...
	for name in bin sbin lib lib64; do ln -s "usr/$name" "$work/tree/$name" && mkdir -p "$work/tree/usr/$name"; done
	while ((running || ${#ready[@]})); do
		kill -0 $apt_pid 2>/dev/null || running=0
		ready=()
		for name in "${!sizes[@]}"; do
			[[ -e $work/done/$name || ! -f $apt/cache/archives/$name ]] || ready+=("$name" "${sizes[$name]}" "${sums[$name]}")
			((${#ready[@]} < 90)) || break # 30 packages at a time, to tell the progress in between
		done
		if ((${#ready[@]})); then
			printf '%s\n' "${ready[@]}" | xargs -P "$(processors)" -n 3 "$setupDir/unpack" "$work" 2>>"$work/unpack.log" ||
				die "a package could not be unpacked: $(tail -n 1 "$work/unpack.log")" "Run this again; the whole output: $work/unpack.log"
		fi
		if ((SECONDS - told >= 15)); then
			told=$SECONDS
			say "... $(find "$work/done" -type f | wc -l) of $count packages"
		fi
		((running == 0 || ${#ready[@]})) || sleep 0.5
	done
	wait $apt_pid || die "the packages could not be downloaded: $(grep -E '^[EW]:' "$apt/log" | head -n 1)" \
		"What is there already is kept; run this again. The whole output: $apt/log"
	trap - EXIT
	local unpacked
	unpacked=$(find "$work/done" -type f | wc -l)
	((unpacked == count)) || die "only $unpacked of $count packages were unpacked." "Run this again; the output of apt: $apt/log"
}

# What maintainer scripts would have done and is needed here, and YADE's headers.
finishRoot() {
	local work=$1 tree=$1/tree name entry
	say "finishing the root"
	find "$tree" -xdev -perm /6000 -type f -exec chmod a-s {} +
	mkdir -p "$tree/etc/ld.so.conf.d" "$tree/usr/src/yade"
	echo /usr/lib/x86_64-linux-gnu/openblas-pthread >"$tree/etc/ld.so.conf.d/openblas.conf"
	for name in passwd group hosts resolv.conf; do [[ -e $tree/etc/$name ]] || : >"$tree/etc/$name"; done
	[[ -f /etc/localtime && ! -e $tree/etc/localtime ]] && : >"$tree/etc/localtime"
	# Snakemake imports a library that wants the authorities' certificates, whether or not it talks to anybody.
	mkdir -p "$tree/etc/ssl/certs"
	cat "$tree"/usr/share/ca-certificates/mozilla/*.crt >"$tree/etc/ssl/certs/ca-certificates.crt"
	enterRoot "$tree"
	local writable=("${entry[@]/#--ro-bind/--bind}")
	requireEntry "${writable[@]}"
	"${writable[@]}" ldconfig -i || die "ldconfig failed in the new root."
	[[ $("${entry[@]}" yade-double --version) == *" $yadeVersion"* ]] || die "the new root's YADE is not version $yadeVersion."
	fetchYadeSource "$work/source"
	unpackYadeSource "$yadeTarball" "$tree/usr/src/yade" "${writable[@]}" python3
}
