# SPDX-License-Identifier: GPL-2.0-or-later
"""Mutations of text files by seed, for the fuzzers of test_fuzz.py."""

import random

#: What parsers stumble over: forms of YAML, CSV and JSON, numbers at the ends of their ranges, odd characters.
TOKENS = (
	"!!bool x", "!!int ''", "!!timestamp", "!!float .nan", "!!python/object:os.system", "!a", "&a", "*a", "<<: *a", "? [1]\n: 2", "%YAML 9.9", "---", "...", "- ", "[" * 40,
	"{a: " * 30, "]", "}", "|\n", ">", "'", '"', "#", ":", ": ", ",", ";", "\t", "\n", "\r\n", "  ", "\0", "\x1b", "\x85", "\ufeff", "\u2028", '"\\ud800"', '"\\U00110000"', "ü", "１２",
	"nan", ".nan", "inf", "-.inf", "Infinity", "NaN", "null", "~", "true", "no", "0", "-0", "-1", "010", "0x10", "0b1", "1:30", "1_000", "1e5", "1e-5", "1e999", "-1e-999", "1.0e+308", "4.9e-324",
	"2147483648", "9" * 30, "9" * 400, "9" * 5000, "0.1.2", "2020-01-01", "2020-13-45", "=", "0.5", "0.0", "1e-9", "1e4", "1e15", "20", "1000000", "$\\foo$", "a" * 300, "/dev/zero", "~nobody/x", "../..",
	'{"a": 1}', "[]", '""',
)  # fmt: skip


def mutated(text, random):
	"""The text with one to four changes."""
	for _ in range(random.choice((1, 1, 1, 2, 2, 4))):
		text = random.choice(_WAYS)(text, random)
	return text


def _token(text, random):
	at = random.randrange(len(text) + 1)
	return text[:at] + random.choice(TOKENS) + text[at:]


def _value(text, random):
	"""Another value behind a separator, in a line."""
	lines = text.split("\n")
	k = random.randrange(len(lines))
	separator = random.choice((": ", ", ", " "))
	head, found, tail = lines[k].rpartition(separator)
	if found:
		lines[k] = head + found + random.choice((*TOKENS, _number(random)))
	return "\n".join(lines)


def _number(random):
	return repr(random.choice((-1, 1)) * 10 ** random.uniform(-20, 20)) if random.random() < 0.8 else str(random.randrange(-3, 10**6))


def _line(text, random):
	"""A line is left out, given twice, moved or has another indentation."""
	lines = text.split("\n")
	k, n = random.randrange(len(lines)), random.randrange(len(lines))
	way = random.randrange(4)
	if way == 0:
		del lines[k]
	elif way == 1:
		lines.insert(n, lines[k])
	elif way == 2:
		lines[k], lines[n] = lines[n], lines[k]
	else:
		lines[k] = " " * random.randrange(5) + lines[k].lstrip()
	return "\n".join(lines) or "\n"


def _cut(text, random):
	low, high = sorted(random.randrange(len(text) + 1) for _ in range(2))
	return text[:low] + text[min(high, low + random.choice((1, 5, 50))) :] if random.random() < 0.8 else text[:high]


def _character(text, random):
	at = random.randrange(len(text) or 1)
	return text[:at] + chr(random.choice((random.randrange(128), random.randrange(128), random.randrange(0xD800)))) + text[at + 1 :]


_WAYS = (_token, _value, _value, _value, _line, _cut, _character)


def mutations(texts, count, seed):
	"""``count`` mutated texts, the k-th from (seed, k) alone."""
	for k in range(count):
		chance = random.Random(f"{seed}-{k}")
		yield k, mutated(chance.choice(texts), chance)
