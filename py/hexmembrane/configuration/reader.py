# SPDX-License-Identifier: GPL-2.0-or-later
"""Reads a configuration's YAML file, and refuses what YAML would misread or blow up. Uses nothing of YADE.

A configuration is nested 'key: value' lines: of YAML's many forms it needs few. Refused are tags, anchors and aliases, keys that are given twice or are no
names, whole numbers that YAML 1.1 takes for octal, sexagesimal, binary or hexadecimal ones, and documents beyond the limits below. What looks like a date is text.
"""

import re

import yaml

from hexmembrane.configuration.schema import ConfigError

#: Largest file [bytes], deepest nesting, most digits of a number, longest key.
MOST_BYTES, MOST_DEEP, MOST_DIGITS, LONGEST_KEY = 256_000, 20, 100, 80
_DECIMAL = re.compile(r"[-+]?(0|[1-9][0-9_]*)")
_LEADING_ZERO = re.compile(r"[-+]?0[0-9_]+")


def read(path):
	"""What the YAML file at ``path`` says: nested dictionaries, lists, texts, numbers and truth values; None for an empty file.

	:raises ConfigError: the file cannot be read or is refused, with the line where there is one.
	"""
	text = _text(path)
	loader = None
	try:
		loader = _Reader(text, path)
		return loader.get_single_data()
	except ConfigError:
		raise
	except yaml.YAMLError as error:
		mark = getattr(error, "problem_mark", None)
		line = mark.line + 1 if mark else text.count("\n", 0, error.position) + 1 if isinstance(error, yaml.reader.ReaderError) else 1
		problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "of an unknown kind"
		raise _refused(path, line, f"is not YAML ({problem})", "correct the line") from None
	except (ValueError, OverflowError, IndexError) as error:  # such as "\U00110000", which PyYAML hands on to chr()
		raise _refused(path, loader.line + 1 if loader else 1, f"is not YAML ({error})", "correct the line") from None
	finally:
		if loader:
			loader.dispose()


def _refused(path, line, wrong, fix):
	return ConfigError("configuration", f"{path}, line {line}", wrong, fix)


def _text(path):
	try:
		with open(path, "rb") as file:
			data = file.read(MOST_BYTES + 1)
	except (OSError, ValueError) as error:
		raise ConfigError("configuration", str(path), f"cannot be read ({getattr(error, 'strerror', None) or error})", "correct the path") from None
	if len(data) > MOST_BYTES:
		raise ConfigError("configuration", str(path), f"is longer than the {MOST_BYTES} bytes that a configuration may have", "give the test's YAML file")
	try:
		return data.decode("utf-8")
	except UnicodeDecodeError:
		raise ConfigError("configuration", str(path), "is not text in UTF-8", "give a YAML file") from None


def _isName(key):
	return 0 < len(key) <= LONGEST_KEY and key.isprintable()


class _Reader(yaml.SafeLoader):
	"""PyYAML's safe loader without what the module's head says."""

	def __init__(self, text, path):
		super().__init__(text)
		self.path, self._keys, self._depth = path, [], 0

	def _refuse(self, node, value, wrong, fix):
		key = ".".join(self._keys)
		raise ConfigError(key or "configuration", value, f"{self.path}, line {node.start_mark.line + 1}: {wrong}", fix)

	# Events to nodes

	def compose_node(self, parent, index):
		key = index.value if isinstance(index, yaml.ScalarNode) else None
		if key is not None:
			self._keys.append(key if _isName(key) else "...")
		self._depth += 1
		self._requirePlain(self.peek_event())
		node = super().compose_node(parent, index)
		self._depth -= 1
		if key is not None:
			self._keys.pop()
		return node

	def _requirePlain(self, event):
		alias = isinstance(event, yaml.events.AliasEvent)
		if alias or event.anchor is not None:
			self._refuse(event, f"{'*' if alias else '&'}{event.anchor}", "anchors and aliases are not taken", "write the value out; text in quotes")
		if event.tag is not None:
			self._refuse(event, event.tag, "tags are not taken", "write the value without it; text in quotes")
		if self._depth > MOST_DEEP:
			self._refuse(event, "...", f"is nested deeper than {MOST_DEEP} levels", "write sections, keys and values only")

	# Nodes to values

	def construct_document(self, node):
		return self._value(node)

	def _value(self, node):
		if isinstance(node, yaml.MappingNode):
			return self._mapping(node)
		if isinstance(node, yaml.SequenceNode):
			return [self._value(item) for item in node.value]
		return self._scalar(node)

	def _mapping(self, node):
		values = {}
		for place, value in node.value:
			name = self._name(place)
			self._keys.append(name)
			if name in values:
				self._refuse(place, getattr(value, "value", None) if isinstance(value, yaml.ScalarNode) else "...", "the key is given twice", "remove one of the two")
			values[name] = self._value(value)
			self._keys.pop()
		return values

	def _name(self, node):
		if not isinstance(node, yaml.ScalarNode):
			self._refuse(node, "...", "a key is no name", "write 'key: value' lines")
		name = node.value
		if node.style is None and not isinstance(self._scalar(node), str):
			self._refuse(node, name, "the key is not text", "write 'key: value' lines")
		if not _isName(name):
			self._refuse(node, name, "the key is no name", "write 'key: value' lines")
		return name

	def _scalar(self, node):
		text = node.value
		if node.style is not None:
			return text
		kind = node.tag.rpartition(":")[2]
		if kind == "null":
			return None
		if kind == "bool":
			return self.bool_values[text.lower()]
		if kind == "int" or _LEADING_ZERO.fullmatch(text):
			return self._whole(node, text)
		if kind == "float":
			if ":" in text:
				self._refuse(node, text, "YAML reads it to the base 60", "write the number in the key's unit; text in quotes")
			return self.construct_yaml_float(node)
		return text

	def _whole(self, node, text):
		if _LEADING_ZERO.fullmatch(text):
			self._refuse(node, text, "YAML reads numbers with a leading zero as octal", f"write {text.lstrip('+-0_') or '0'} for a number; text in quotes")
		if ":" in text:
			self._refuse(node, text, "YAML reads it to the base 60", "write the number in the key's unit; text in quotes")
		if not _DECIMAL.fullmatch(text):
			self._refuse(node, text, "is not a decimal number", "write it with the digits 0 to 9; text in quotes")
		if len(text) > MOST_DIGITS:
			self._refuse(node, text, f"has more than {MOST_DIGITS} digits", "write a number in the key's range")
		return int(text.replace("_", ""))
