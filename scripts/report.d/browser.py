# SPDX-License-Identifier: GPL-2.0-or-later
"""Chromium without a window, spoken to through two pipes: no port is opened, no library is needed."""

import base64
import contextlib
import fcntl
import json
import os
import select
import signal
import subprocess
import tempfile
import time

_OPTIONS = (
	"--headless",
	"--remote-debugging-pipe",
	"--hide-scrollbars",
	# drawn by the processor, as on a machine without a graphics card
	"--use-angle=swiftshader",
	"--enable-unsafe-swiftshader",
	# only scenes are drawn so, as a browser without a card does it: by way of it pages are slow, and an answer waits for all that is to be drawn before
	"--disable-gpu-compositing",
	# a browser in a container has no sandbox of its own, and little shared memory; it opens our own files only
	"--no-sandbox",
	"--disable-gpu-sandbox",
	"--disable-dev-shm-usage",
	# slow drawing on a loaded machine is no hang, and a page that nobody sees must go on
	"--disable-gpu-watchdog",
	"--disable-background-timer-throttling",
	"--disable-backgrounding-occluded-windows",
	"--disable-renderer-backgrounding",
	"--disable-background-networking",
	"--no-first-run",
)
#: Lowest numbers of our ends of the pipes: 3 and 4 are the browser's.
_HIGH = 10
#: Height of a screenshot at most [pixels]: higher ones have their beginning again at their end.
_HIGHEST = 8000
#: Milliseconds between two looks whether something has come true.
_PAUSE = 30
#: Seconds that a page has to be loaded.
_LOADING = 30.0
#: Seconds that a browser has to end by itself.
_PARTING = 5.0


class BrowserError(RuntimeError):
	"""The browser has ended, does not answer, or what was asked of a page failed."""


class Browser:
	"""A browser; ``events``: what it has told so far, (method, parameters).

	:param program: to start. :param limit: seconds that it has for an answer. :param patience: seconds that a page has to show what was asked of it.
	"""

	def __init__(self, program, limit=60.0, patience=10.0):
		self.limit, self.patience, self._number, self._rest, self.events = limit, patience, 0, b"", []
		(commands, self._out), (self._in, answers) = os.pipe(), os.pipe()
		os.set_blocking(self._out, False)
		theirs = [fcntl.fcntl(end, fcntl.F_DUPFD, _HIGH) for end in (commands, answers)]
		self._folder = tempfile.TemporaryDirectory(prefix="hexmembrane-browser-", ignore_cleanup_errors=True)
		start = ["bash", "-c", f'exec "$@" 3<&{theirs[0]} 4>&{theirs[1]}', "bash", program, *_OPTIONS, f"--user-data-dir={self._folder.name}", "about:blank"]
		# a session of its own: its processes can be ended together
		self._process = subprocess.Popen(start, pass_fds=theirs, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
		for end in (commands, answers, *theirs):
			os.close(end)

	def ask(self, method, session=None, **parameters):
		"""A command's answer, a dict.

		:raises BrowserError: it failed, the browser has ended, or there is no answer within the limit.
		"""
		self._number += 1
		message = {"id": self._number, "method": method, "params": parameters, **({"sessionId": session} if session else {})}
		end = time.monotonic() + self.limit
		try:
			self._send(json.dumps(message).encode() + b"\0", end)
			while (found := self._message(end)).get("id") != self._number:
				pass
		except TimeoutError:
			raise BrowserError(f"{method}: no answer within {self.limit:g} s") from None
		except BrokenPipeError:
			raise BrowserError(f"{method}: the browser has ended") from None
		if "error" in found:
			raise BrowserError(f"{method}: {found['error']}")
		return found["result"]

	def _ready(self, end, *writing):
		"""Which of the two pipes is ready, (to be read, to be written). A browser that tells without end has a limit too.

		:raises TimeoutError: none is until ``end``.
		"""
		left = end - time.monotonic()
		ready = select.select([self._in], writing, [], left)[:2] if left > 0 else ([], [])
		if not any(ready):
			raise TimeoutError
		return ready

	def _send(self, data, end):
		# what the browser tells is read meanwhile: it may read no further before
		while data:
			told, free = self._ready(end, self._out)
			if told:
				self._read()
			if free:
				data = data[os.write(self._out, data) :]

	def _read(self):
		if not (block := os.read(self._in, 1 << 20)):
			raise BrokenPipeError
		self._rest += block

	def _message(self, end):
		while b"\0" not in self._rest:
			self._ready(end)
			self._read()
		if time.monotonic() > end:
			raise TimeoutError
		line, _, self._rest = self._rest.partition(b"\0")
		found = json.loads(line)
		if "method" in found:
			self.events.append((found["method"], found.get("params", {})))
		return found

	def close(self):
		"""End the browser and all its processes."""
		self.limit = min(self.limit, _PARTING)
		with contextlib.suppress(BrowserError):
			self.ask("Browser.close")
			with contextlib.suppress(subprocess.TimeoutExpired):
				self._process.wait(_PARTING)
		with contextlib.suppress(ProcessLookupError):
			os.killpg(self._process.pid, signal.SIGKILL)
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
		if not self.until("document.readyState === 'complete'", _LOADING):
			raise BrowserError(f"{address}: is not loaded within {_LOADING:g} s")
		self.run(ready)

	def ask(self, method, **parameters):
		return self._browser.ask(method, self._session, **parameters)

	def resize(self, width, height):
		"""Width and height of the window [pixels], and a picture of that size drawn."""
		self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
		self.until(f"innerWidth === {width} && innerHeight === {height}")
		self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(() => done()))))")

	def run(self, expression):
		"""The value of an expression of JavaScript, awaited.

		:raises BrowserError: it threw, or is not there within the browser's limit.
		"""
		try:
			found = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True, userGesture=True)
		except BrowserError as error:
			raise BrowserError(f"{expression[:80]}: {error}") from None
		if "exceptionDetails" in found:
			details = found["exceptionDetails"]
			raise BrowserError(f"{expression[:80]}: {details.get('exception', {}).get('description') or details.get('text')}")
		return found["result"].get("value")

	def until(self, expression, seconds=None):
		"""Whether an expression has come true within some seconds; None: the browser's patience."""
		seconds = self._browser.patience if seconds is None else seconds
		return self.run(f"""new Promise((done) => {{
			const end = performance.now() + {1000 * seconds};
			const look = () => ({expression}) ? done(true) : performance.now() > end ? done(false) : setTimeout(look, {_PAUSE});
			look();
		}})""")

	def press(self, key, code=0):
		"""Press and release a key; a single character is typed."""
		typed = {"text": key} if len(key) == 1 else {}
		self.ask("Input.dispatchKeyEvent", type="keyDown", key=key, code=key, windowsVirtualKeyCode=code, **typed)
		self.ask("Input.dispatchKeyEvent", type="keyUp", key=key, code=key, windowsVirtualKeyCode=code)

	def drag(self, *places):
		"""Press the mouse at the first of some (x, y) of the window, move it over the others, release it at the last."""
		kinds = ["mouseMoved", "mousePressed", *["mouseMoved"] * (len(places) - 1), "mouseReleased"]
		for kind, (x, y) in zip(kinds, [places[0], *places, places[-1]]):
			held = {"button": "none"} if kind == "mouseMoved" and (x, y) == places[0] else {"button": "left", "buttons": 1, "clickCount": 1}
			self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **held)

	def point(self, x, y):
		"""Move the mouse to a place of the window."""
		self.ask("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

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

	def picture(self, path, of=":root"):
		"""A screenshot of an element as PNG, by its selector, the whole page by default; smaller than it is where it is too high for one picture."""
		x, y, width, height = self.run(f"""(() => {{
			const {{ left, top, width, height }} = document.querySelector({json.dumps(of)}).getBoundingClientRect();
			return [left + scrollX, top + scrollY, width, height];
		}})()""")
		clip = {"x": x, "y": y, "width": width, "height": height, "scale": min(1, _HIGHEST / height)}
		shot = self.ask("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
		path.write_bytes(base64.b64decode(shot["data"]))

	def pdf(self, path):
		"""The page as it is printed on A4."""
		printed = self.ask("Page.printToPDF", preferCSSPageSize=False, paperWidth=8.27, paperHeight=11.69, printBackground=True)
		path.write_bytes(base64.b64decode(printed["data"]))

	def close(self):
		self._browser.ask("Target.closeTarget", targetId=self._target)
