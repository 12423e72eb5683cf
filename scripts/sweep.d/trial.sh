# shellcheck shell=bash
# Sourced by slurm-test and ends-test, after setup.sh: what trials of whole studies have in common.

# beginTrial FOLDER: sets folder, which must be new, and prepares.
beginTrial() {
	folder=$(realpath -m "$1")
	[[ ! -e $folder ]] || die "$folder: is there already." "fix: remove it, or give another folder"
	prepare hexmembrane
	mkdir -p "$folder"
}

# inBackground NAME ARGUMENT...: scripts/sweep with the study into the folder NAME; sets study, its process.
inBackground() {
	local name=$1
	shift
	"$checkout/scripts/sweep" "$folder/study.yaml" --out "$folder/$name" "$@" &
	study=$!
}

# waitFor WHAT COMMAND...: until the command succeeds, as long as the study in the background runs, if there is one.
waitFor() {
	local what=$1 end=$((SECONDS + 1200))
	shift
	until "$@"; do
		{ ((SECONDS < end)) && { [[ -z ${study:-} ]] || kill -0 "$study" 2>/dev/null; }; } || die "there never was $what." "look into $folder"
		sleep 0.2
	done
}

# requireSame NAME NAME: the tables of two studies are equal, byte for byte.
requireSame() {
	local table
	for table in runs.csv means.csv; do
		cmp "$folder/$1/$table" "$folder/$2/$table" || die "$table of $2 is another one than of $1."
	done
	say "the tables of $2 are those of $1"
}
