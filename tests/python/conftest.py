# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line of a test in the YADE that runs the tests."""

import pytest


@pytest.fixture
def runHere(O, capsys):
	"""The same command line in this YADE: (exit code, stdout, stderr)."""

	from hexmembrane.run.command import main

	def run(*arguments):
		O.reset()
		code = main([str(argument) for argument in arguments])
		said = capsys.readouterr()
		return code, said.out, said.err

	return run
