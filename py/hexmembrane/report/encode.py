# SPDX-License-Identifier: GPL-2.0-or-later
"""Numbers as a page holds them: whole numbers of 16 bits between a low and a high value, differences from frame to frame, compressed, as base64.

``page/data.js`` reads them. Uses nothing of YADE.
"""

import base64
import json
import zlib

import numpy as np

#: The code of nan; all others are values.
_NAN = 65535
#: Digits of numbers in JSON.
_DIGITS = 6


def _text(data):
	return base64.b64encode(zlib.compress(data, 6)).decode()


def array(values):
	"""Values (frames, n, parts) to ``{"shape", "low", "high", "data"}``; their error is (high - low)/131068 at most, nan stays nan."""
	values = np.asarray(values, dtype=float)
	seen = values[np.isfinite(values)]
	low, high = (float(seen.min()), float(seen.max())) if len(seen) else (0.0, 0.0)
	codes = np.where(np.isfinite(values), np.rint((values - low) * ((_NAN - 1) / (high - low) if high > low else 0.0)), _NAN).astype(np.uint16)
	steps = codes.copy()
	steps[1:] -= codes[:-1]  # whole numbers of 16 bits turn round at the end
	# low and high bytes apart: the high ones hardly change, and compress
	planes = steps.astype("<u2").reshape(-1, 1).view(np.uint8).T
	return {"shape": list(values.shape), "low": low, "high": high, "data": _text(planes.tobytes())}


def whole(values):
	"""Whole numbers below 2^32, of any shape, to ``{"shape", "data"}``, exactly."""
	values = np.ascontiguousarray(values, dtype="<u4")
	return {"shape": list(values.shape), "data": _text(values.tobytes())}


def numbers(values):
	"""Numbers as a list for JSON, to six digits; nan and what is not finite as None."""
	return [float(f"{value:.{_DIGITS}g}") if np.isfinite(value) else None for value in np.asarray(values, dtype=float)]


def script(content):
	"""JSON that can stand in an element ``script`` of HTML: no text in it ends the element or begins a comment."""
	text = json.dumps(content, allow_nan=False, ensure_ascii=True, separators=(",", ":"))
	return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
