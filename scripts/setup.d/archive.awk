# awk -v codename=CODENAME -f archive.awk FILE...: the address of Debian's own archive in apt's source files (*.sources: deb822, others:
# one line a source), or nothing. It is the first source of a release of Debian, CODENAME or another, with the component main. A source
# signed with another key than Debian's is somebody else's, though for the same release. The address of a list of mirrors
# (mirror+file:...) is an address as others are: apt itself reads the list.

function isRelease(name) {
	return name != "" && (name == codename || name ~ /^(trixie|stable|oldstable|oldoldstable|testing|unstable|sid)$/)
}

# Whether one of the words is `wanted`, or names a release of Debian.
function has(words, wanted,   list, n, i) {
	n = split(words, list)
	for (i = 1; i <= n; i++) if (wanted == "release" ? isRelease(list[i]) : list[i] == wanted) return 1
	return 0
}

function consider(types, uris, suites, components, signed,   list) {
	if (found != "" || !(has(types, "deb") || has(types, "deb-src")) || !has(suites, "release") || !has(components, "main")) return
	if (signed != "" && signed !~ /debian-archive/) return
	split(uris, list)
	if (list[1] !~ /^cdrom:/) found = list[1]
}

function endStanza() {
	if (tolower(value["enabled"]) !~ /^[ \t]*(no|false|0|off|without|disable)[ \t]*$/)
		consider(value["types"], value["uris"], value["suites"], value["components"], value["signed-by"])
	split("", value)
	field = ""
}

FNR == 1 { endStanza(); deb822 = FILENAME ~ /[.]sources$/ }
{ sub(/\r$/, "") }
/^[ \t]*#/ { next }
!deb822 {
	sub(/[ \t]#.*/, "")
	signed = ""
	if (match($0, /\[[^]]*\]/)) {
		options = substr($0, RSTART + 1, RLENGTH - 2)
		$0 = substr($0, 1, RSTART - 1) " " substr($0, RSTART + RLENGTH)
		if (match(options, /signed-by=[^ \t]+/)) signed = substr(options, RSTART, RLENGTH)
	}
	type = $1; uri = $2; suite = $3
	$1 = $2 = $3 = ""
	consider(type, uri, suite, $0, signed)
	next
}
/^[ \t]*$/ { endStanza(); next }
/^[ \t]/ { value[field] = value[field] " " $0; next }
{
	field = tolower(substr($0, 1, index($0, ":") - 1))
	value[field] = substr($0, index($0, ":") + 1)
}
END { endStanza(); if (found != "") print found }
