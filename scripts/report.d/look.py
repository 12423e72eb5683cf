# SPDX-License-Identifier: GPL-2.0-or-later
"""look.py BROWSER OUT PAGE...: opens reports as a reader does and tells what is wrong; screenshots and prints go to OUT. The exit code is 1 when something is."""

import pathlib
import sys

from browser import Browser, BrowserError, Page

SIZES = {"wide": (1440, 900), "middle": (820, 1100), "narrow": (390, 844)}
THEMES = ("light", "dark")
_LEFT, _RIGHT, _DOWN = 37, 39, 40
#: Least share of a scene's picture that is drawn, and how many colours it has at least.
_DRAWN, _COLOURS = 0.01, 10
#: Least contrast of text with what is behind it (WCAG 2, AA). Curves have it too: the numbers at their ends have their colours.
_TEXT = 4.5
#: Least contrasts of text against the page and the card, and of curves against the card.
_CONTRASTS = """(() => {
	const channel = (one) => { one /= 255; return one <= 0.03928 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4; };
	const light = (colour) => { const c = d3.rgb(colour); return 0.2126 * channel(c.r) + 0.7152 * channel(c.g) + 0.0722 * channel(c.b); };
	const contrast = (a, b) => { const [low, high] = [light(a), light(b)].sort((p, q) => p - q); return (high + 0.05) / (low + 0.05); };
	const style = getComputedStyle(document.documentElement), value = (name) => style.getPropertyValue(`--${name}`).trim();
	const least = (names, ...behind) => Math.min(...behind.flatMap((one) => names.map((name) => contrast(value(name), value(one)))));
	return [least(["ink", "soft", "accent", "good", "bad", "open"], "card", "back"), least([0, 1, 2, 3, 4, 5, 6, 7].map((k) => `line${k}`), "card")];
})()"""
_WIDER = "[...document.querySelectorAll('main, section, nav, header')].filter((one) => one.scrollWidth > innerWidth + 1).map((one) => one.id || one.tagName)"
_UNNAMED = """[...document.querySelectorAll("button, input, select, [role=img], a")]
	.filter((one) => !(one.textContent.trim() || one.getAttribute("aria-label") || one.labels?.[0]?.textContent.trim()))
	.map((one) => one.outerHTML.slice(0, 80))"""
#: Width and height of a scene [pixels] and pictures a second while it is turned, as fine as the screen.
_SPEED = """(async () => {
	const scene = report.state.parts[0];
	await scene.ready;
	scene.setRatio(1);
	await scene.measure(8);
	return [scene.stage.clientWidth, scene.stage.clientHeight, await scene.measure(60)];
})()"""
#: Share of the scene's picture that is drawn, and the number of its colours; null without a scene.
_PICTURE = """(() => {
	const scene = report.state.parts[0];
	if (!scene?.renderer) return null;
	scene.render();
	const gl = scene.renderer.getContext(), { width, height } = scene.renderer.domElement, pixels = new Uint32Array(width * height);
	gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(pixels.buffer));
	return [pixels.filter((one) => one >>> 24).length / pixels.length, new Set(pixels).size];
})()"""
#: The first figure of curves that is shown, brought into the window, and where its middle is; null without one.
_FIGURE = """(() => {
	const figure = (window.looked = document.querySelector(".panels figure:not([hidden]) svg"));
	if (!figure) return null;
	figure.scrollIntoView({ block: "center", behavior: "instant" });
	const { left, top, width, height } = figure.getBoundingClientRect();
	return [left, top, width, height];
})()"""
_READOUT = "looked.parentElement.querySelector('.readout').textContent"
_RANGE = "[...looked.querySelector('.axis').querySelectorAll('.tick text')].map((one) => one.textContent).join(' ')"
#: What is told of force chains after their box is clicked, what is shown of the grains, and whether the picture has the tubes.
_CHAINS = """(async () => {
	const scene = report.state.parts[0];
	if (!scene?.chains) return null;
	[...document.querySelectorAll(".tools label")].find((one) => one.textContent === "force chains").querySelector("input").click();
	await scene.fill();
	scene.render();
	return [scene.told.textContent, scene.options.grains, scene.renderer.info.render.triangles >= 2 * scene.chains.count];
})()"""


def _moves(page, wrong):
	"""Slider and list of tests by keys."""
	if page.run("!document.getElementById('slide').hidden"):
		page.run("document.getElementById('strain').focus()")
		page.run("window.before = document.getElementById('at').textContent")
		page.press("ArrowLeft", _LEFT)
		if not page.until("document.getElementById('at').textContent !== before"):
			wrong.append("the slider does not move by keys")
	if page.run("report.content.runs.length") > 1:
		page.run("document.getElementById('run').focus()")
		page.press("ArrowDown", _DOWN)
		if not page.until("report.state.run === report.content.runs[1]"):
			wrong.append(f"the list of tests does not pick {page.run('report.content.runs[1].name')}")
		page.run("Promise.all(report.state.parts.map((part) => part.ready))")


def _zooms(page, wrong):
	"""Values under the cursor and zoom of the curves, by mouse and by keys."""
	if (place := page.run(_FIGURE)) is None:
		return
	left, top, width, height = place
	page.point(left + 0.4 * width, top + 0.4 * height)
	if not page.until(f"{_READOUT}.startsWith('at ')"):
		wrong.append("there are no values under the cursor")
	whole = page.run(_RANGE)
	page.drag(*((left + share * width, top + 0.5 * height) for share in (0.3, 0.35, 0.5)))
	if not page.until(f"{_RANGE} !== {whole!r}"):
		wrong.append("curves do not zoom by mouse")
	page.run("looked.focus()")
	page.press("0", ord("0"))
	if not page.until(f"{_RANGE} === {whole!r}"):
		wrong.append("curves do not show all by a key")
	page.run(f"window.before = {_READOUT}")
	page.press("ArrowRight", _RIGHT)
	if not page.until(f"{_READOUT} !== before"):
		wrong.append("the cursor of curves does not move by keys")
	page.press("+")
	if not page.until(f"{_RANGE} !== {whole!r}"):
		wrong.append("curves do not zoom by keys")
	page.press("0", ord("0"))


def _turns(page, wrong):
	"""The scene by keys."""
	if not page.run("report.state.parts[0]?.stage !== undefined"):
		return
	page.run("(report.state.parts[0].stage.focus(), window.before = report.state.parts[0].camera.position.x)")
	page.press("ArrowRight", _RIGHT)
	if not page.until("report.state.parts[0].camera.position.x !== before"):
		wrong.append("the scene does not turn by keys")


def _figures(page, wrong):
	"""Each figure's SVG and CSV, as its buttons make them."""
	saved = page.run("""(async () => {
		const kept = [], before = report.save;
		report.save = (name, type, text) => kept.push([name, type, text]);
		for (const button of document.querySelectorAll("figure:not([hidden]) figcaption button")) button.click();
		report.save = before;
		const told = (type, text) => type === "text/csv" ? text.split("\\n").length : new DOMParser().parseFromString(text, type).documentElement.nodeName;
		return kept.map(([name, type, text]) => [name, text.length, told(type, text)]);
	})()""")
	for name, size, told in saved:
		if size < 100 or told == "parsererror" or (name.endswith(".csv") and told < 3):
			wrong.append(f"{name} has {size} characters and {told}")
	return len(saved)


def _speeds(page, name):
	"""Prints how fast the scene is at the three sizes, and its force chains at the first."""
	grains = page.run("report.state.parts[0].data.grains.position.shape[1]")
	for size in SIZES.values():
		page.resize(*size)
		width, height, speed = page.run(_SPEED)
		print(f"{name}: {grains} grains at {speed:.0f} pictures a second, {width} x {height} pixels")
	page.resize(*SIZES["wide"])
	if page.run(_CHAINS) is not None:
		print(f"{name}: their force chains at {page.run(_SPEED)[2]:.0f}")
		page.run(_CHAINS)


def _sees(page, theme, sizes, shot, wrong):
	"""Screenshots at the sizes and with force chains, what is wider than the window, contrasts, whether the scene is drawn. shot: path of a screenshot by what it has."""
	for label, size in sizes.items():
		page.resize(*size)
		page.picture(shot(label))
		if wider := page.run(_WIDER):
			wrong.append(f"{label}: {wider} are wider than the window")
		if (drawn := page.run(_PICTURE)) is not None and (drawn[0] < _DRAWN or drawn[1] < _COLOURS):
			wrong.append(f"{label}: of the scene {100 * drawn[0]:.2g} % are drawn, in {drawn[1]} colours")
	text, curve = page.run(_CONTRASTS)
	if min(text, curve) < _TEXT:
		wrong.append(f"{theme}: contrast of text {text:.2f}, of curves {curve:.2f}")
	page.resize(*SIZES["wide"])
	if (chains := page.run(_CHAINS)) is not None:
		if " carry " not in chains[0] or chains[1] != "none" or not chains[2]:
			wrong.append(f"force chains tell {chains}")
		page.picture(shot("chains"), ".stage")
		page.run(_CHAINS)


def look(browser, path, out, themes=THEMES, sizes=SIZES, speeds=True):
	"""What is wrong with a page, a list.

	:param out: folder of screenshots and print. :param speeds: whether the scene's pictures a second are measured and printed.
	"""
	wrong, name = [], path.stem
	for theme in themes:
		page = Page(browser, path.resolve().as_uri(), SIZES["wide"], theme == "dark")
		_sees(page, theme, sizes, lambda what: out / f"{name}-{what}-{theme}.png", wrong)
		if theme == themes[0]:
			_zooms(page, wrong)
			_turns(page, wrong)
			_moves(page, wrong)
			print(f"{name}: {_figures(page, wrong)} files of figures")
			if speeds and page.run("report.state.parts[0]?.measure !== undefined"):
				_speeds(page, name)
			if page.run("window.harmed !== undefined"):
				wrong.append("a text of a test was run")
			page.pdf(out / f"{name}.pdf")
		wrong += [f"without a name: {one}" for one in page.run(_UNNAMED)]
		wrong += page.errors()
		page.close()
	return wrong


def main(program, out, *pages):
	out = pathlib.Path(out)
	out.mkdir(parents=True, exist_ok=True)
	bad = False
	with Browser(program) as browser:
		for path in map(pathlib.Path, pages):
			try:
				wrong = look(browser, path, out)
			except BrowserError as error:
				wrong = [str(error)]
			print(f"{path}: " + ("well" if not wrong else "; ".join(wrong)))
			bad = bad or bool(wrong)
	return int(bad)


if __name__ == "__main__":
	sys.exit(main(*sys.argv[1:]))
