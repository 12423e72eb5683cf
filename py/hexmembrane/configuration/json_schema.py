# SPDX-License-Identifier: GPL-2.0-or-later
"""The JSON Schema (draft 2020-12) of a configuration, made of the keys as they are stated. Uses nothing of YADE.

It says what one key may be. What concerns several keys at once only ``scripts/run --check`` tells.
"""

import dataclasses
import math
import typing

from hexmembrane.configuration.config import Config
from hexmembrane.configuration.schema import REQUIRED

#: YAML 1.1 reads 1e5 as text, which the configuration takes for a number.
_NUMBER = r"^\s*[-+]?[0-9_]*\.?[0-9_]+([eE][-+]?[0-9]+)?\s*$"


def jsonSchema():
	"""The schema as nested dictionaries that JSON can hold."""
	made = _object(Config)
	made["properties"]["base"] = {"type": "string", "description": "another configuration, which this one changes"}
	made["properties"]["made"] = {"type": "object", "description": "how a resolved configuration came about; not read"}
	# with a base any key may be in that file
	made = {"if": {"not": {"required": ["base"]}}, "then": {"required": made.pop("required", []) + ["specimen", "consolidation"]}, **made}
	return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "hexmembrane triaxial test", **made}


def _object(cls):
	hints, properties, required = typing.get_type_hints(cls), {}, []
	for field in dataclasses.fields(cls):
		if "section" in field.metadata:
			properties[field.name] = {"description": field.metadata["doc"], "anyOf": [_object(field.metadata["section"]), {"type": "null"}]}
			continue
		spec = field.metadata["key"]
		properties[field.name] = {**_type(hints[field.name], spec), "description": spec.doc + (f" [{spec.unit}]" if spec.unit else "")}
		if field.default is REQUIRED:
			required.append(field.name)
		elif field.default is not None:
			properties[field.name]["default"] = field.default
	return {"type": "object", "additionalProperties": False, "properties": properties, **({"required": required} if required and cls is not Config else {})}


def _type(annotation, spec):
	arguments = [argument for argument in typing.get_args(annotation) if argument is not type(None)]
	if type(None) in typing.get_args(annotation):
		return {"anyOf": [_type(arguments[0], spec), {"type": "null"}]}
	if dataclasses.is_dataclass(annotation):
		return _object(annotation)
	if typing.get_origin(annotation) is list:
		return {"type": "array", "items": _type(arguments[0], spec)}
	if typing.get_origin(annotation) is dict:
		return {"type": "object", "additionalProperties": _type(arguments[1], spec)}
	if annotation is bool:
		return {"type": "boolean"}
	if annotation in (int, float):
		limits = {}
		if spec.low > -math.inf:
			limits["exclusiveMinimum" if spec.openLow else "minimum"] = spec.low
		if spec.high < math.inf:
			limits["exclusiveMaximum" if spec.openHigh else "maximum"] = spec.high
		return {"type": ["integer" if annotation is int else "number", "string"], "pattern": _NUMBER, **limits}
	return {"type": "string", **({"enum": list(spec.choices)} if spec.choices else {"maxLength": spec.longest})}
