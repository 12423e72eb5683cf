# SPDX-License-Identifier: GPL-2.0-or-later
"""The reader of configurations refuses what YAML would misread or blow up, with line, key, value and fix."""

import time

import pytest
from hexmembrane import configuration
from hexmembrane.configuration import reader
from hexmembrane.configuration.schema import ConfigError

#: Nine levels of nine aliases each: 387 million texts.
BOMB = "a0: &a0 lol\n" + "".join(f"a{k + 1}: &a{k + 1} [{', '.join([f'*a{k}'] * 9)}]\n" for k in range(9))
# file, key, value in the message, line, what is wrong, fix
REFUSED = {
	"octal": ("specimen:\n  seed: 010\n", "specimen.seed", "'010'", 2, "octal", "write 10"),
	"leading zero": ("specimen:\n  seed: 09\n", "specimen.seed", "'09'", 2, "octal", "write 9"),
	"base 60": ("shear:\n  strain: 1:30\n", "shear.strain", "'1:30'", 2, "base 60", "in the key's unit"),
	"base 60, broken": ("shear: {strain: 190:20:30.15}\n", "shear.strain", "'190:20:30.15'", 1, "base 60", "in the key's unit"),
	"hexadecimal": ("specimen: {seed: 0x10}\n", "specimen.seed", "'0x10'", 1, "is not a decimal number", "digits 0 to 9"),
	"binary": ("specimen: {seed: 0b10}\n", "specimen.seed", "'0b10'", 1, "is not a decimal number", "digits 0 to 9"),
	"400 digits": ("specimen:\n  seed: " + "9" * 400, "specimen.seed", "'999", 2, "more than 100 digits", "the key's range"),
	"5000 digits": ("specimen:\n  seed: " + "9" * 5000, "specimen.seed", "'999", 2, "more than 100 digits", "the key's range"),
	"tag": ("output:\n  energy: !!bool x\n", "output.energy", "'tag:yaml.org,2002:bool'", 2, "tags are not taken", "without it"),
	"tag of a date": ("title: !!timestamp now\n", "title", "'tag:yaml.org,2002:timestamp'", 1, "tags are not taken", "without it"),
	"empty number": ('specimen: {seed: !!int ""}\n', "specimen.seed", "'tag:yaml.org,2002:int'", 1, "tags are not taken", "without it"),
	"object": ("!!python/object/apply:os.system ['true']", "configuration", "'tag:yaml.org,2002:python", 1, "tags are not taken", "without it"),
	"local tag": ("title: !text a\n", "title", "'!text'", 1, "tags are not taken", "without it"),
	"alias bomb": (BOMB, "a0", "'&a0'", 1, "anchors and aliases are not taken", "write the value out"),
	"alias": ("title: *a\n", "title", "'*a'", 1, "anchors and aliases are not taken", "write the value out"),
	"merge": ("specimen:\n  <<: &a {seed: 1}\n", "specimen.<<", "'&a'", 2, "anchors and aliases are not taken", "write the value out"),
	"deep": ("[" * 5000, "configuration", "'...'", 1, "nested deeper than 20 levels", "sections, keys and values"),
	"deep mappings": ("{a: " * 5000, ".".join(["a"] * 19), "'...'", 1, "nested deeper than 20 levels", "sections, keys and values"),
	"key twice": ("title: a\ntitle: b", "title", "'b'", 2, "the key is given twice", "remove one"),
	"key of a list": ("? [1, 2]\n: 3", "configuration", "'...'", 1, "a key is no name", "'key: value'"),
	"key of a number": ("1: 3", "configuration", "'1'", 1, "the key is not text", "'key: value'"),
	"long key": ("k" * 100 + ": 3", "configuration", "'kkk", 1, "the key is no name", "'key: value'"),
	"key with a line end": ('"a\\nb": 3', "configuration", r"'a\nb'", 1, "the key is no name", "'key: value'"),
	"no character": ('title: "\\U00110000"', "configuration", "", 1, "is not YAML", "correct the line"),
	"NUL": ("title: a\nshear: \0", "configuration", "", 2, "is not YAML", "correct the line"),
	"two documents": ("title: a\n---\ntitle: b\n", "configuration", "", 2, "is not YAML", "correct the line"),
	"huge": ("title: " + "a" * 300000, "configuration", "", None, "longer than the 256000 bytes", "YAML file"),
}
# Values that the reader takes and the keys refuse.
LATER = {
	"impossible date": ("specimen: {seed: 2020-13-45}", "specimen.seed = '2020-13-45': is not a whole number"),
	"value tag": ("specimen: {seed: =}", "specimen.seed = '=': is not a whole number"),
	"large integer": ("numerics: {substeps: 2147483648}", "numerics.substeps = 2147483648: is out of range"),
	"integer beyond floats": ("specimen: {seed: " + "9" * 99 + "}", "is out of range"),
	"number beyond floats": ("shear: {strain: 1.0e+999}", "shear.strain = inf: is not finite"),
	"lone surrogate": ('title: "a\\ud800b"', r"title = 'a\ud800b': has the character U+D800"),
	"control character": ('title: "a\\e[31mb"', r"title = 'a\x1b[31mb': has the character U+001B"),
	"long title": ("title: " + "a" * 300, "has 300 characters; fix: give at most 200"),
	"NUL in a path": ('specimen: {gradation: "a\\0b"}', r"specimen.gradation = 'a\x00b': has the character U+0000"),
	"nobody's home": ("specimen: {gradation: ~nobody-of-that-name/sand.csv}", "there is no such file"),
	"long path": ("specimen: {gradation: " + "a" * 3000 + "}", "there is no such file"),
	"NUL in a base": ('base: "a\\0b"', r"base = 'a\x00b': has the character U+0000"),
	"unit": ("specimen: {radius: 20000}", "specimen.radius = 20000: is beyond what a test can have, 1e-09 to 10000 m; fix: check the unit"),
	"unit, small": ("consolidation: {pressure: 1.0e-9}", "consolidation.pressure = 1e-09: is beyond what a test can have, 0.001 to 1e+15 Pa"),
}



def refusal(folder, text):
	(folder / "test.yaml").write_bytes(text.encode())
	began = time.monotonic()
	with pytest.raises(ConfigError) as caught:
		configuration.load(folder / "test.yaml")
	assert time.monotonic() - began < 2
	message = str(caught.value)
	assert message.count("; fix: ") == 1 and "\n" not in message and len(message) < 1000
	return message


@pytest.mark.parametrize("name", REFUSED)
def test_refused(tmp_path, name):
	text, key, value, line, wrong, fix = REFUSED[name]
	message = refusal(tmp_path, text)
	assert message.startswith(f"{key} = ") and value in message and wrong in message and fix in message.partition("; fix: ")[2]
	assert line is None or f"test.yaml, line {line}" in message


@pytest.mark.parametrize("name", LATER)
def test_refusedByItsKey(tmp_path, name):
	text, wanted = LATER[name]
	(tmp_path / "base.yaml").write_text("specimen: {radius: 0.02, height: 0.08, gradation: base.yaml, grains: 100}\nconsolidation: {pressure: 1.0e5}\n")
	assert wanted in refusal(tmp_path, text if "base:" in text else f"base: base.yaml\n{text}\n")


@pytest.mark.parametrize(
	"text, value",
	[
		("a", "a"), ("'010'", "010"), ("2020-01-01", "2020-01-01"), ("'1:30'", "1:30"), ("10", 10), ("-1_000", -1000), ("0", 0), ("1.5e+3", 1500.0), ("1e3", "1e3"),
		("yes", True), ("off", False), ("~", None), ("", None), ("'&a'", "&a"), ('"*"', "*"), ("$\\foo$", "$\\foo$"), ("[1, [2]]", [1, [2]]),
	],
)  # fmt: skip
def test_taken(tmp_path, text, value):
	(tmp_path / "test.yaml").write_text(f"key: {text}\n")
	assert reader.read(tmp_path / "test.yaml") == {"key": value}


def test_endlessFile():
	"""A device is no configuration, and is not read to its end."""
	with pytest.raises(ConfigError, match="longer than the 256000 bytes"):
		reader.read("/dev/zero")


def test_chainOfBases(tmp_path):
	"""A hundred files, one the base of the next."""
	for k in range(100):
		(tmp_path / f"{k}.yaml").write_text(f"base: {k + 1}.yaml\n")
	with pytest.raises(ConfigError, match=r"^base = '2\d.yaml': is the base of more than 20 files; fix: "):
		configuration.load(tmp_path / "0.yaml")


def test_sameListTwice(tmp_path):
	"""A configuration that holds the same object twice is written without an alias."""
	from test_config import GOOD

	(tmp_path / "sand.csv").write_text("any")
	same = [1.0, 2.0]
	configuration.save(configuration.Config.of(GOOD, tmp_path), tmp_path / "saved.yaml", budget={"a": same, "b": same})
	assert reader.read(tmp_path / "saved.yaml")["made"]["budget"] == {"a": same, "b": same}
