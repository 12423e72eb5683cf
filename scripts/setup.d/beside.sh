# shellcheck shell=bash
# Programs that one command alone needs: fetched when it is first asked for, into a folder of their own beside the private root, so that nobody else
# downloads them and the root stays as it is. A folder is made under another name and renamed when its program has started.

# setUpBeside FOLDER WHAT SIZE OMIT PACKAGE...: unpacks into FOLDER.part/tree what PACKAGEs need beyond those of the root, without the files whose names
# match OMIT; sets work. Fails when another run has made FOLDER meanwhile. Its lock is held until finishBeside.
setUpBeside() {
	local folder=$1 what=$2 megabytes=$3 omit=$4 name size sum
	shift 4
	work=$folder.part
	local packages names=() needed=() apt=$work/apt
	needAptTools
	lock 9 root
	if [[ -d $folder ]]; then # made by the run that was waited for
		exec 9>&-
		return 1
	fi
	removeTree "$work"
	mkdir -p "$work"/{tree,done}
	privateApt "$apt"
	listOf excludes >"$work/excludes"
	mapfile -t packages < <(listOf packages && listOf root-only)
	filesFor "$apt" "${packages[@]}" >"$work/root"
	filesFor "$apt" "${packages[@]}" "$@" >"$work/both"
	mapfile -t needed < <(LC_ALL=C comm -13 "$work/root" "$work/both" | grep -v "$omit")
	((${#needed[@]})) || die "apt lists no package for $what." "the lists: $work/root, $work/both"
	for name in "${needed[@]}"; do names+=("${name%%_*}"); done
	say "downloading $what for this command (${#names[@]} packages, about $megabytes)"
	(cd "$apt/cache/archives" && apt-get -q=2 download "${names[@]}") >"$apt/log" 2>&1 ||
		die "$what could not be downloaded: $(grep -E '^[EW]:' "$apt/log" | head -n 1)" "Run this again; the whole output: $apt/log"
	for name in "${needed[@]}"; do
		read -r name size sum <<<"$name"
		"$setupDir/unpack" "$work" "$name" "$size" "${sum#SHA256:}" || die "the package $name could not be unpacked." "Run this again."
	done
}

# finishBeside FOLDER WHAT SCRIPT ARGUMENT...: the script $work/SCRIPT, which starts the program, becomes executable and is tried; then FOLDER has its name.
finishBeside() {
	local folder=$1 what=$2 script=$3
	shift 3
	chmod +x "$work/$script"
	"${entry[@]}" "$work/$script" "$@" >"$work/log" 2>&1 || die "$what does not start: $(tail -n 1 "$work/log")" "the whole output: $work/log"
	removeTree "$work/apt"
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
