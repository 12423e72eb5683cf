# SPDX-License-Identifier: GPL-2.0-or-later
"""Chromium without a window, spoken to through two pipes: no port is opened, no library is needed."""

import base64
import contextlib
import fcntl
import json
import os
import select
import subprocess
import tempfile
import time

#: Drawn by the processor, as on a machine without a graphics card. A browser in a container has no sandbox of its own; it opens our own files only.
_OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--remote-debugging-pipe")
#: Lowest numbers of our ends of the pipes: 3 and 4 are the browser's.
_HIGH = 10


class BrowserError(RuntimeError):
	"""The browser has ended, does not answer, or what was asked of a page failed."""


class Browser:
	"""A browser; ``events``: what it has told so far, (method, parameters).

	:param program: to start. :param limit: seconds that it has for an answer.
	"""

	def __init__(self, program, limit=120.0):
		self._limit, self._number, self._rest, self.events = limit, 0, b"", []
		(commands, self._out), (self._in, answers) = os.pipe(), os.pipe()
		theirs = [fcntl.fcntl(end, fcntl.F_DUPFD, _HIGH) for end in (commands, answers)]
		self._folder = tempfile.TemporaryDirectory(prefix="hexmembrane-browser-", ignore_cleanup_errors=True)
		start = ["bash", "-c", f'exec "$@" 3<&{theirs[0]} 4>&{theirs[1]}', "bash", program, *_OPTIONS, f"--user-data-dir={self._folder.name}", "about:blank"]
		self._process = subprocess.Popen(start, pass_fds=theirs, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
		for end in (commands, answers, *theirs):
			os.close(end)

	def ask(self, method, session=None, **parameters):
		"""A command's answer, a dict. :raises BrowserError: it failed."""
		self._number += 1
		message = {"id": self._number, "method": method, "params": parameters, **({"sessionId": session} if session else {})}
		os.write(self._out, json.dumps(message).encode() + b"\0")
		end = time.monotonic() + self._limit
		while True:
			found = self._message(end)
			if found.get("id") == self._number:
				if "error" in found:
					raise BrowserError(f"{method}: {found['error']}")
				return found["result"]

	def _message(self, end):
		while b"\0" not in self._rest:
			left = end - time.monotonic()
			if left <= 0 or not select.select([self._in], [], [], left)[0]:
				raise BrowserError(f"no answer within {self._limit:g} s")
			if not (block := os.read(self._in, 1 << 20)):
				raise BrowserError("the browser has ended")
			self._rest += block
		line, _, self._rest = self._rest.partition(b"\0")
		found = json.loads(line)
		if "method" in found:
			self.events.append((found["method"], found.get("params", {})))
		return found

	def close(self):
		"""End the browser."""
		with contextlib.suppress(BrowserError, OSError):
			self.ask("Browser.close")
		with contextlib.suppress(subprocess.TimeoutExpired):
			self._process.wait(10)
		self._process.kill()
		self._process.wait()
		for end in (self._out, self._in):
			os.close(end)
		self._folder.cleanup()

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.close()


class Page:
	"""A page in a browser, opened at an address and waited for.

	:param size: width and height [pixels]. :param dark: whether the reader's system is dark. :param ready: an expression that the page is waited for by.
	"""

	def __init__(self, browser, address, size, dark=False, ready="report.ready"):
		self._browser, self._before = browser, len(browser.events)
		target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
		self._target, self._session = target, browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
		for domain in ("Page", "Runtime", "Log", "Network"):
			self.ask(f"{domain}.enable")
		self.resize(*size)
		self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
		self.ask("Page.navigate", url=address)
		self.run("new Promise((done) => (document.readyState === 'complete' ? done() : addEventListener('load', done)))")
		self.run(ready)

	def ask(self, method, **parameters):
		return self._browser.ask(method, self._session, **parameters)

	def resize(self, width, height):
		self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

	def run(self, expression):
		"""The value of an expression of JavaScript, awaited. :raises BrowserError: it threw."""
		found = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True, userGesture=True)
		if "exceptionDetails" in found:
			details = found["exceptionDetails"]
			raise BrowserError(f"{expression[:80]}: {details.get('exception', {}).get('description') or details.get('text')}")
		return found["result"].get("value")

	def press(self, key, code=0):
		"""Press and release a key."""
		for kind in ("keyDown", "keyUp"):
			self.ask("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)

	def errors(self):
		"""What the page's console told as errors, and addresses that it asked for beyond its own file."""
		found = []
		for method, given in self._browser.events[self._before :]:
			if method == "Runtime.exceptionThrown":
				found.append(given["exceptionDetails"].get("exception", {}).get("description") or given["exceptionDetails"]["text"])
			elif method == "Log.entryAdded" and given["entry"]["level"] == "error":
				found.append(given["entry"]["text"])
			elif method == "Runtime.consoleAPICalled" and given["type"] in ("error", "assert"):
				found.append(str(given["args"]))
			elif method == "Network.requestWillBeSent" and not given["request"]["url"].startswith(("file:", "data:", "blob:")):
				found.append(f"asked for {given['request']['url']}")
		return found

	def picture(self, path, whole=True):
		"""A screenshot as PNG, of the whole page or of what is seen."""
		shot = {"format": "png"}
		if whole:
			size = self.ask("Page.getLayoutMetrics")["cssContentSize"]
			shot.update(captureBeyondViewport=True, clip={"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1})
		path.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", **shot)["data"]))

	def pdf(self, path):
		"""The page as it is printed on A4."""
		printed = self.ask("Page.printToPDF", preferCSSPageSize=False, paperWidth=8.27, paperHeight=11.69, printBackground=True)
		path.write_bytes(base64.b64decode(printed["data"]))

	def close(self):
		self._browser.ask("Target.closeTarget", targetId=self._target)
