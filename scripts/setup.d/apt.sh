# shellcheck shell=bash
# A private apt for Debian 13's archive, beside that of the system: needs no privileges and changes nothing outside its folder.

debianKeyring=/usr/share/keyrings/debian-archive-keyring.gpg

howToNameAnArchive="fix: export HEXMEMBRANE_DEBIAN_ARCHIVE=ADDRESS, that of a mirror of Debian's archive: the folder with dists/trixie in it"

# chooseArchive APT RELEASE: sets debianArchive, the archive's address: what HEXMEMBRANE_DEBIAN_ARCHIVE says, else the one that this
# system has its own packages from, if it is a Debian of any release. No address stands in hexmembrane: which mirror is near and
# allowed only the system's owner knows. APT is apt's folder of configuration, RELEASE the file that names the system.
chooseArchive() {
	local apt=$1 release=$2 file files=()
	debianArchive=${HEXMEMBRANE_DEBIAN_ARCHIVE:-}
	if [[ -n $debianArchive ]]; then
		[[ $debianArchive =~ ^[a-z][a-z+]*:/[^[:space:]]+$ ]] ||
			die "HEXMEMBRANE_DEBIAN_ARCHIVE = $debianArchive: not the address of an archive (METHOD:/...)." "$howToNameAnArchive"
		return
	fi
	[[ $(osField "$release" ID) == debian ]] ||
		die "HEXMEMBRANE_DEBIAN_ARCHIVE = : not set, and this system is no Debian, whose own archive could be taken." "$howToNameAnArchive"
	for file in "$apt/sources.list" "$apt"/sources.list.d/*.list "$apt"/sources.list.d/*.sources; do
		if [[ -r $file ]]; then files+=("$file"); fi
	done
	((${#files[@]} == 0)) || debianArchive=$(awk -v codename="$(osField "$release" VERSION_CODENAME)" -f "$setupDir/archive.awk" "${files[@]}")
	[[ -n $debianArchive ]] ||
		die "HEXMEMBRANE_DEBIAN_ARCHIVE = : not set, and apt's sources in $apt name no archive of Debian." "$howToNameAnArchive"
}

# What must be there on the host itself.
needAptTools() {
	local tool missing=()
	for tool in apt-get apt-cache apt-config dpkg-deb tar sha256sum xargs flock; do
		command -v "$tool" >/dev/null || missing+=("$tool")
	done
	# apt verifies signatures with either
	command -v gpgv >/dev/null || command -v sqv >/dev/null || missing+=(gpgv)
	((${#missing[@]} == 0)) || die "this system lacks: ${missing[*]}" \
		"The set-up downloads Debian 13's packages with apt and dpkg, so it needs a Debian, Ubuntu or related system." \
		"Elsewhere build the plugin for a YADE of your own: see 'With a YADE of your own' in README.md."
	[[ -r $debianKeyring ]] || die "there is no $debianKeyring: the packages could not be verified." \
		"fix: apt-get install debian-archive-keyring"
}

# privateApt FOLDER: writes the configuration for an apt whose whole state lies in FOLDER. Packages named in leftout.list count as
# installed, so that they and what only they need stay out.
privateApt() {
	local folder=$1 name
	chooseArchive /etc/apt /etc/os-release
	mkdir -p "$folder"/{state/lists/partial,cache/archives/partial,none/partial,etc/apt.conf.d,etc/preferences.d}
	export APT_CONFIG=$folder/apt.conf
	{
		# The way to the network is the system's: proxies, certificates, passwords of mirrors. Most systems set none of it: no line is no error.
		env -u APT_CONFIG apt-config dump 2>/dev/null | grep -E '^Acquire::https?::' || true
		cat <<-END
			APT::Architecture "amd64";
			APT::Architectures { "amd64"; };
			APT::Install-Recommends "false";
			APT::Sandbox::User "";
			APT::Update::Error-Mode "any";
			Acquire::ForceHash "SHA256";
			Acquire::Languages "none";
			Acquire::Retries "3";
			Acquire::http::Timeout "30";
			Dir::State "$folder/state";
			Dir::State::status "$folder/status";
			Dir::Cache "$folder/cache";
			Dir::Etc "$folder/etc";
			Dir::Etc::netrc "/etc/apt/auth.conf";
			Dir::Etc::netrcparts "/etc/apt/auth.conf.d";
			Dir::Log "$folder";
		END
	} >"$APT_CONFIG"
	local signed="[signed-by=$debianKeyring]"
	printf '%s %s %s trixie main\n' deb "$signed" "$debianArchive" deb-src "$signed" "$debianArchive" >"$folder/etc/sources.list"
	for name in $(listOf leftout); do
		printf 'Package: %s\nStatus: install ok installed\nMaintainer: none <none@localhost>\nArchitecture: amd64\n' "$name"
		printf 'Multi-Arch: foreign\nVersion: 999:1\nDescription: left out\n\n'
	done >"$folder/status"
	say "reading the package index of Debian 13 ($debianArchive)"
	if ! apt-get -q=2 update >"$folder/log" 2>&1; then
		if grep -qE 'NO_PUBKEY|EXPKEYSIG|KEYEXPIRED' "$folder/log"; then
			die "the keys in $debianKeyring do not verify Debian 13's archive: they are too old." \
				"fix: apt-get install --only-upgrade debian-archive-keyring (it must know 'trixie')"
		fi
		die "Debian's archive $debianArchive could not be read: $(grep -E '^[EW]:' "$folder/log" | head -n 1)" \
			"Nothing was set up. fix: check the network (and the proxy of apt), then run this again." \
			"Another mirror: HEXMEMBRANE_DEBIAN_ARCHIVE=ADDRESS; the whole output: $folder/log"
	fi
}

# fetchYadeSource FOLDER: leaves YADE's upstream tarball in FOLDER and sets yadeTarball. Needs privateApt. The headers are in that
# tarball; the other files of a source package are not needed, and some mirrors lack them, on which apt-get ends with an error: what
# counts is that the tarball's sum is the one in apt's signed index.
fetchYadeSource() {
	local folder=$1 uri name size sum
	mkdir -p "$folder"
	read -r uri name size sum < <(apt-get source --print-uris --download-only yade 2>/dev/null | grep -E ' yade_[^ ]+[.]orig[.]tar[.][a-z0-9]+ ') ||
		die "Debian's archive $debianArchive has no sources of yade." "Another mirror: HEXMEMBRANE_DEBIAN_ARCHIVE=ADDRESS"
	[[ $name == "yade_$yadeVersion.orig.tar."* && $sum == SHA256:* ]] ||
		die "Debian's archive has the sources $name ($sum), wanted is YADE $yadeVersion." "hexmembrane supports Debian 13's YADE $yadeVersion."
	yadeTarball=$folder/$name
	sumIsRight() { [[ -f $yadeTarball ]] && echo "${sum#SHA256:}  $yadeTarball" | sha256sum --check --status; }
	if ! sumIsRight; then
		say "downloading YADE's sources ($((size / 1000000)) MB)"
		rm -f "$yadeTarball"
		# apt-get may fail on what is no matter here (signature of the .dsc, say): what counts is the sum of the file, asked next
		(cd "$folder" && apt-get -q=2 source --download-only yade) >"$folder/log" 2>&1 || true
		sumIsRight || die "YADE's sources could not be downloaded from ${uri//\'/}" "the output of apt-get: $folder/log"
	fi
}

# unpackYadeSource TARBALL FOLDER PYTHON...: only what the plugin is compiled against. By Python, since bzip2 may be missing.
unpackYadeSource() {
	local tarball=$1 folder=$2
	shift 2
	"$@" - "$tarball" "$folder" <<-'END'
		import sys, tarfile
		with tarfile.open(sys.argv[1]) as archive:
		    wanted = []
		    for member in archive:
		        member.name = member.name.partition("/")[2]
		        if (member.isfile() or member.isdir()) and member.name.split("/")[0] in ("core", "lib", "pkg", "RELEASE"):
		            wanted.append(member)
		    archive.extractall(sys.argv[2], wanted, filter="data")
	END
	[[ $(cat "$folder/RELEASE") == "$yadeVersion" ]] || die "YADE's sources in $tarball are not version $yadeVersion."
}
