# SPDX-License-Identifier: GPL-2.0-or-later
"""Checked sections of a configuration, built from dataclasses.

A section is a dataclass whose fields are made by :func:`key`; each states its purpose, unit, default and range once, and
that one statement checks the input, writes the resolved configuration and makes the table of keys in the documentation.
A section may have a method ``check(path)`` for what concerns several keys at once, and a class method ``prepared(values)`` for defaults that depend on
what is given.
"""

import csv
import dataclasses
import difflib
import functools
import math
import pathlib
import typing
import unicodedata

from hexmembrane.configuration import pfc

#: Characters of a value that a message shows.
_SHOWN = 200
#: Longest text that a key has, and longest path of a file.
LONGEST_TEXT, LONGEST_PATH = 200, 4000
#: What a number other than 0 is at least and at most in size, by unit: beyond it is a slip of the unit, and products of such numbers leave the range of floats.
SIZES = {
	"m": (1e-9, 1e4), "m/s": (1e-12, 1e4), "s": (1e-15, 1e9), "Pa": (1e-3, 1e15), "N": (1e-12, 1e12), "N/m": (1e-6, 1e15), "N m": (1e-18, 1e9), "kg/m3": (1e-3, 1e9),
	"N/m3": (1e-3, 1e21), "deg": (1e-6, 360), "": (1e-15, 1e9)
}  # fmt: skip


class ConfigError(ValueError):
	"""Bad configuration: the message names the key's path, its value, what is wrong and the fix; so do ``path``, ``value``, ``wrong`` and ``fix``."""

	def __init__(self, path, value, wrong, fix):
		self.path, self.value, self.wrong, self.fix = path, value, wrong, fix
		super().__init__(f"{path} = {shown(value)}: {wrong}; fix: {fix}")


def shown(value):
	"""The value as a message shows it, on one line and not longer than a line or two."""
	try:
		text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
	except (ValueError, RecursionError):  # Python writes no integer of more than 4300 digits
		text = f"<{type(value).__name__}>"
	return text if len(text) <= _SHOWN else text[: _SHOWN // 2] + " ... " + text[-_SHOWN // 4 :]


def plainText(path, value, longest):
	"""``value``, a text, checked: printable characters of no more than ``longest``.

	:raises ConfigError: it has control characters, halves of characters (lone surrogates) or is too long.
	"""
	odd = next((character for character in value if unicodedata.category(character) in ("Cc", "Cs")), None)
	if odd is not None:
		raise ConfigError(path, value, f"has the character U+{ord(odd):04X}, which no text line has", "leave it out")
	if len(value) > longest:
		raise ConfigError(path, value, f"has {len(value)} characters", f"give at most {longest}")
	return value


@dataclasses.dataclass(frozen=True)
class Key:
	"""What is known of one key.

	``low`` and ``high`` are inclusive unless the matching ``open...`` is set. ``free``: the value may differ when a test is resumed, since it does
	not change what has been computed. ``infinite``: inf (YAML's .inf) is a value. ``longest``: characters of a text.
	"""

	doc: str
	unit: str = ""
	low: float = -math.inf
	high: float = math.inf
	openLow: bool = False
	openHigh: bool = False
	choices: tuple = ()
	free: bool = False
	infinite: bool = False
	longest: int = LONGEST_TEXT

	def range(self):
		"""The allowed values in words, '' when everything of the type is allowed."""
		if self.choices:
			return " or ".join(f"'{choice}'" for choice in self.choices)
		low = "" if self.low == -math.inf else ("> " if self.openLow else ">= ") + f"{self.low:g}"
		high = "" if self.high == math.inf else ("< " if self.openHigh else "<= ") + f"{self.high:g}"
		return ", ".join(part for part in (low, high) if part)

	def holds(self, value):
		below = value <= self.low if self.openLow else value < self.low
		above = value >= self.high if self.openHigh else value > self.high
		return not below and not above


def key(default, doc, unit="", **more):
	"""A dataclass field for one configuration key; ``default=REQUIRED`` makes the key compulsory; ``more``: fields of :class:`Key`."""
	return dataclasses.field(default=default, metadata={"key": Key(doc, unit, **more)})


#: Defaults and ranges that keys have in common with classes of the plugin.
SHARED = pathlib.Path(__file__).with_name("shared.csv")


@functools.lru_cache
def _sharedRows():
	lines = [line for line in SHARED.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
	return {row["name"]: row for row in csv.DictReader(lines)}


def shared(name, doc, unit="", **more):
	"""As :func:`key`, with the default and range of a row of ``shared.csv``, which the plugin's class has too; ``more`` goes before the row.

	``more`` may have ``default``.
	"""
	row = _sharedRows()[name]
	facts = {end: float(row[end]) for end in ("low", "high") if row[end]}
	facts.update({"openLow" if end == "low" else "openHigh": True for end in ("low", "high") if row["open"] == end})
	if row["choices"]:
		facts["choices"] = tuple(row["choices"].split("|"))
	facts.update(more)
	if "default" not in facts:
		facts["default"] = row["default"] if row["choices"] else (float if "." in row["default"] else int)(row["default"])
	return key(facts.pop("default"), doc, unit, **facts)


class _Required:
	def __repr__(self):
		return "required"


REQUIRED = _Required()


def section(cls, doc):
	"""A dataclass field for a section of class ``cls``."""
	return dataclasses.field(default_factory=cls, metadata={"section": cls, "doc": doc})


def sections(cls):
	"""The fields of ``cls`` that are sections themselves."""
	return [field for field in dataclasses.fields(cls) if "section" in field.metadata]


def _bare(annotation):
	"""(type, may be None) of a field's annotation."""
	args = [arg for arg in typing.get_args(annotation) if arg is not type(None)]
	if typing.get_origin(annotation) is typing.Union or type(None) in typing.get_args(annotation):
		return args[0], True
	return annotation, False


def _number(path, value, kind, spec):
	"""``value`` as a finite float or an int; text such as '1e5', which YAML 1.1 does not take for a number, is accepted."""
	wanted = f"a {'whole ' if kind is int else ''}number" + (f" in {spec.unit}" if spec.unit else "")
	fix = f"give {wanted}" + (f" {spec.range()}" if spec.range() else "")
	if isinstance(value, bool) or not isinstance(value, (int, float, str)) and not hasattr(value, "__float__"):
		raise ConfigError(path, value, f"is not {wanted}", fix)
	try:
		number = float(value)
	except (TypeError, ValueError):
		raise ConfigError(path, value, f"is not {wanted}", fix) from None
	except OverflowError:
		raise ConfigError(path, value, "is larger than any number of a computer", fix) from None
	if not math.isfinite(number) and not (spec.infinite and number == math.inf):
		raise ConfigError(path, value, "is not finite", fix)
	if kind is int:
		if number != int(number):
			raise ConfigError(path, value, "is not a whole number", fix)
		number = int(value) if isinstance(value, int) else int(number)
	if not spec.holds(number):
		raise ConfigError(path, value, f"is out of range, {spec.range()} is allowed", fix)
	least, most = SIZES[spec.unit]
	if kind is float and number != 0 and not least <= abs(number) <= most and number != math.inf:
		raise ConfigError(path, value, f"is beyond what a test can have, {least:g} to {most:g} {spec.unit}".rstrip(), f"check the unit and {fix}")
	return number


def _value(path, value, annotation, spec):
	"""``value`` checked against the key's type and range, and converted."""
	kind, optional = _bare(annotation)
	if dataclasses.is_dataclass(kind):
		return build(kind, value, path)
	if value is None:
		if optional:
			return None
		raise ConfigError(path, value, "has no value", f"give one or remove the key: {spec.doc}")
	if typing.get_origin(kind) is list:
		if not isinstance(value, (list, tuple)):
			raise ConfigError(path, value, "is not a list", "write [first, second, ...]")
		return [_value(f"{path}[{i}]", item, typing.get_args(kind)[0], spec) for i, item in enumerate(value)]
	if typing.get_origin(kind) is dict:
		if not isinstance(value, dict):
			raise ConfigError(path, value, "is not a mapping", "write {name: value, ...}")
		return {plainText(path, str(name), spec.longest): _value(f"{path}.{name}", item, typing.get_args(kind)[1], spec) for name, item in value.items()}
	if kind in (int, float):
		return _number(path, value, kind, spec)
	if kind is bool:
		if not isinstance(value, bool):
			raise ConfigError(path, value, "is neither true nor false", "write true or false")
		return value
	if not isinstance(value, str) and not hasattr(value, "__fspath__"):
		raise ConfigError(path, value, "is not text", "give text" + (f": {spec.range()}" if spec.choices else ""))
	value = plainText(path, str(value), spec.longest)
	if spec.choices and value not in spec.choices:
		raise ConfigError(path, value, "is not one of the choices", f"{_guess(value, spec.choices)}use {spec.range()}")
	return value


def _guess(name, known):
	close = difflib.get_close_matches(str(name), known, 1, 0.6)
	return f"did you mean '{close[0]}'? " if close else ""


def build(cls, mapping, path=""):
	"""An instance of the section ``cls`` from a mapping (or an instance, whose values are checked again).

	:raises ConfigError: unknown key, wrong type, not finite, out of range, missing.
	"""
	if isinstance(mapping, cls):
		mapping = toDict(mapping)
	mapping = {} if mapping is None else mapping
	if not isinstance(mapping, dict):
		raise ConfigError(path or "configuration", mapping, "is not a mapping of keys", "write 'key: value' lines")
	hints = typing.get_type_hints(cls)
	fields = {field.name: field for field in dataclasses.fields(cls)}
	at = f"{path}." if path else ""
	for name in mapping:
		if name in getattr(cls, "REPLACED", ()):
			raise ConfigError(f"{at}{name}", mapping[name], "is no key any more", cls.REPLACED[name])
		if name not in fields and (here := pfc.named(name, path)):
			raise ConfigError(f"{at}{name}", mapping[name], "is PFC's name", f"here it is {here}")
		if name not in fields:
			raise ConfigError(
				f"{at}{name}", mapping[name], "unknown key", f"{_guess(name, fields)}known keys are {', '.join(fields)}"
			)
	if hasattr(cls, "prepared"):
		mapping = cls.prepared(mapping)
	values = {}
	for name, field in fields.items():
		if "section" in field.metadata:
			values[name] = build(field.metadata["section"], mapping.get(name), at + name)
			continue
		spec = field.metadata["key"]
		if name in mapping:
			values[name] = _value(at + name, mapping[name], hints[name], spec)
		elif field.default is REQUIRED:
			raise ConfigError(at + name, None, "is missing", f"give {spec.doc}" + (f" ({spec.unit})" if spec.unit else ""))
		else:
			values[name] = field.default
	instance = cls(**values)
	if hasattr(instance, "check"):
		instance.check(path)
	return instance


def toDict(instance):
	"""The section as nested plain dictionaries, in the order of the fields."""
	return dataclasses.asdict(instance)


def paths(values, path=""):
	"""Paths of the keys in nested dictionaries, such as 'shear.velocity'."""
	found = []
	for name, value in values.items():
		at = f"{path}.{name}" if path else str(name)
		found += paths(value, at) if isinstance(value, dict) else [at]
	return found


def freeKeys(cls, path=""):
	"""Paths of the keys in ``cls`` and its sections that are ``free``."""
	paths = []
	for field in dataclasses.fields(cls):
		name = f"{path}.{field.name}" if path else field.name
		if "section" in field.metadata:
			paths += freeKeys(field.metadata["section"], name)
		elif field.metadata["key"].free:
			paths.append(name)
	return paths


#: A key's type in words.
_WORDS = {float: "number", int: "whole number", bool: "true/false", str: "text"}


def table(cls, path=""):
	"""Rows (key path, type, unit, default, range, doc) of every key in ``cls`` and its sections."""
	hints = typing.get_type_hints(cls)
	rows = []
	for field in dataclasses.fields(cls):
		name = f"{path}.{field.name}" if path else field.name
		if "section" in field.metadata:
			rows += table(field.metadata["section"], name)
			continue
		spec = field.metadata["key"]
		kind, optional = _bare(hints[field.name])
		kind = "list of stages" if _entry(hints[field.name]) else _WORDS.get(kind) or ("mapping" if typing.get_origin(kind) is dict else "list of numbers")
		default = "none" if field.default is None else str(field.default).lower() if kind == "true/false" else str(field.default)
		if isinstance(field.default, float):
			default = f"{field.default:g}"
		rows.append((name, kind + (" or none" if optional else ""), spec.unit, default, spec.range(), spec.doc))
	return rows


#: SI unit -> the units that a value is told in, the largest first.
_TOLD_IN = {"Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1, "Pa")), "m": ((1, "m"), (1e-3, "mm"))}


@functools.lru_cache
def _units(cls):
	return {name: unit for name, _, unit, *_ in table(cls)}


def told(cls, path, value):
	"""A value of the key at a path as it is read best, such as '50 kPa' and '0.75 mm'; what is no number as it is."""
	if not isinstance(value, (int, float)) or isinstance(value, bool):
		return str(value)
	unit = _units(cls).get(path, "")
	units = _TOLD_IN.get(unit, ((1, "" if unit == "-" else unit),))
	factor, unit = next((one for one in units if abs(value) >= one[0]), units[-1])
	return f"{value / factor:g} {unit}".rstrip()


def _entry(annotation):
	"""The class of the entries of a list of sections, None for any other type."""
	kind = next(iter(typing.get_args(_bare(annotation)[0])), None)
	return kind if dataclasses.is_dataclass(kind) else None


def markdown(cls):
	"""The tables of keys for the documentation, one Markdown table for the top level, one for each section and one for the entries of each list of sections."""
	inner = {field.name for field in sections(cls)}
	parts = [("top level", [row for row in table(cls) if row[0].split(".")[0] not in inner])]
	parts += [(f"`{field.name}`: {field.metadata['doc']}", table(field.metadata["section"])) for field in sections(cls)]
	entries = {name: _entry(hint) for name, hint in typing.get_type_hints(cls).items()}
	parts += [(f"an entry of `{name}`", table(entry)) for name, entry in entries.items() if entry]
	lines = []
	for title, rows in parts:
		lines += [f"### {title}", "", "| key | unit | default | range | purpose |", "| --- | --- | --- | --- | --- |"]
		for name, kind, unit, default, allowed, doc in rows:
			allowed = ", ".join(part for part in (kind, allowed) if part)
			lines.append(f"| `{name}` | {unit} | {default} | {allowed} | {doc} |")
		lines.append("")
	return "\n".join(lines)
