# SPDX-License-Identifier: GPL-2.0-or-later
"""Mutated inputs: an error with key, value and fix, or a test that can be begun. ``HEXMEMBRANE_FUZZ``: mutations of a configuration, a quarter of it of the others."""

import os
import pathlib
import signal
import time

import pytest
import yaml
from hexmembrane import configuration
from hexmembrane.configuration import ConfigError
from hexmembrane.run import pipeline
from hexmembrane.scene import packing_file, specimen
from mutations import mutations
from tinyTest import GRADATION, TINY

COUNT = int(os.environ.get("HEXMEMBRANE_FUZZ", 400))
SEED = os.environ.get("HEXMEMBRANE_FUZZ_SEED", "1")
#: Longest time of a processor [s] that an input may take.
PATIENCE = 10
EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"


class Slow(BaseException):
	pass


def tooSlow(number, frame):
	raise Slow


def outcomes(texts, count, attempt):
	"""'refused' and 'taken' counted; fails with the number of each mutation whose outcome is neither."""
	before = signal.signal(signal.SIGPROF, tooSlow)
	counts, odd = {"refused": 0, "taken": 0}, []
	try:
		for k, text in mutations(texts, count, SEED):
			began = time.process_time()
			signal.setitimer(signal.ITIMER_PROF, PATIENCE)
			try:
				attempt(text)
				counts["taken"] += 1
			except ConfigError as error:
				counts["refused"] += 1
				message = str(error)
				if message.count("; fix: ") < 1 or " = " not in message or "\n" in message or len(message) > 1500:
					odd.append((k, message[:300]))
			except (Slow, Exception) as error:
				odd.append((k, f"{type(error).__name__}: {str(error)[:300]} after {time.process_time() - began:.1f} s"))
			finally:
				signal.setitimer(signal.ITIMER_PROF, 0)
	finally:
		signal.signal(signal.SIGPROF, before)
	assert odd == [], f"{len(odd)} of {count} with seed {SEED}: {odd[:20]}"
	return counts


def write(path, text):
	path.write_bytes(text.encode("utf-8", "surrogatepass"))
	return path


def begin(path, out):
	"""All that is done before anything is made."""
	pipeline.prepare(configuration.load(path), out, lambda line: None)


@pytest.fixture
def folder(tmp_path):
	write(tmp_path / "sand.csv", GRADATION)
	return tmp_path


def test_configuration(folder):
	quick = configuration.load(EXAMPLES / "quick.yaml")
	configuration.save(quick, folder / "resolved.yaml")
	small = {**configuration.toDict(quick), "specimen": TINY["specimen"]}
	texts = [
		yaml.safe_dump(TINY),
		yaml.safe_dump({**TINY, "accuracy": 0.3, "boundary": "wall"}),
		yaml.safe_dump(small, sort_keys=False),
		(folder / "resolved.yaml").read_text(),
		(EXAMPLES / "quick.yaml").read_text().replace("data/", f"{EXAMPLES}/data/"),
		"base: quick.yaml\nshear:\n  velocity: 0.1\nnumerics: {dt: 1.0e-6, safety: 0.4}\nmembrane: {pressureTime: .inf, particleRadius: 0.001, placement: centred}\n",
	]
	write(folder / "quick.yaml", texts[0])
	counts = outcomes(texts, COUNT, lambda text: begin(write(folder / "test.yaml", text), folder / "out"))
	assert min(counts.values()) > COUNT / 20, counts


def test_gradation(folder):
	texts = [GRADATION, (EXAMPLES / "data" / "toyoura.csv").read_text(), "d [m];p\n0,001;0\n0,002;50\n\n# a\n0,003;100\n"]

	def attempt(text):
		write(folder / "sand.csv", text)
		keys = configuration.Config.of({**TINY, "specimen": {**TINY["specimen"], "gradation": str(folder / "sand.csv")}}).specimen
		sizes = specimen.radii(keys, keys.radius, keys.height)
		assert len(sizes) == keys.grains and (sizes > 0).all()

	counts = outcomes(texts, COUNT // 4, attempt)
	assert min(counts.values()) > COUNT / 100, counts


def test_packing(folder):
	radii = [1e-3, 0.8e-3, 1.2e-3]
	packing_file.save(packing_file.Packing([(0, 0, 2e-3), (3e-3, 0, 4e-3), (0, -3e-3, 8e-3)], radii, 0.02, 0.05, seed=1, gradation="x", extra={"a": [1]}), folder / "good.txt")
	changes = {**TINY["specimen"], "packing": str(folder / "test.txt")}
	del changes["gradation"], changes["grains"]

	def attempt(text):
		write(folder / "test.txt", text)
		pipeline.prepare(configuration.Config.of({**TINY, "specimen": changes}), folder / "out", lambda line: None)

	counts = outcomes([(folder / "good.txt").read_text()], COUNT // 4, attempt)
	assert counts["taken"] > 0 and counts["refused"] > COUNT / 10, counts
