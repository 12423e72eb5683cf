# SPDX-License-Identifier: GPL-2.0-or-later
"""The checkpoint's JSON: whole or refused."""

import json

import pytest
from hexmembrane.run import checkpoints
from hexmembrane.run.checkpoints import CheckpointError


def test_roundTrip(tmp_path):
	(tmp_path / "a.yade.gz").write_bytes(b"x")
	facts = {"rows": 3, "last": {"q": 0.1 + 0.2}, "frames": [[0.5, 1]]}
	checkpoints.write(tmp_path, "a.yade.gz", facts)
	found = checkpoints.read(tmp_path)
	assert found == {"version": checkpoints.VERSION, "state": "a.yade.gz", **facts}
	assert sorted(p.name for p in tmp_path.iterdir()) == ["a.yade.gz", "checkpoint.json"]


@pytest.mark.parametrize(
	"text, message",
	[
		(None, "there is none"),
		("", "is damaged"),
		('{"version": 1, "sta', "is damaged"),
		("[1]", "is not of version"),
		(json.dumps({"version": 99, "state": "a"}), "is not of version"),
		(json.dumps({"version": checkpoints.VERSION, "state": "gone.yade.gz"}), "'gone.yade.gz' is missing"),
	],
)
def test_refused(tmp_path, text, message):
	if text is not None:
		(tmp_path / "checkpoint.json").write_text(text)
	with pytest.raises(CheckpointError, match=f"{message}.*; fix: run without --resume"):
		checkpoints.read(tmp_path)


def test_differences():
	old = {"a": 1, "b": {"c": 2, "d": [1, 2]}, "e": 1}
	assert checkpoints.differences(old, old) == []
	assert checkpoints.differences(old, {"a": 1, "b": {"c": 3, "d": [1, 2]}, "f": 0}) == ["b.c", "e", "f"]
