// A page of a test that runs loads itself anew, and is then as the reader has left it: zoom, curves, view of the specimen, place on the page.
{
	const NAME = "hexmembrane-report",
		PATIENCE = 1000;
	let pressed = false;

	// What was kept before the page was loaded anew, null at first; a browser may refuse to keep anything.
	report.before = () => {
		try {
			const kept = JSON.parse(sessionStorage.getItem(NAME));
			sessionStorage.removeItem(NAME);
			return kept?.address === location.pathname ? kept : null;
		} catch (error) {
			return null;
		}
	};

	// After the seconds that the page says, and not while something is dragged. view: gives what is to be kept.
	report.renew = (view) => {
		for (const [name, down] of [
			["pointerdown", true],
			["pointerup", false],
			["pointercancel", false],
		])
			addEventListener(name, () => (pressed = down), true);
		const load = () => {
			if (pressed) {
				setTimeout(load, PATIENCE);
				return;
			}
			try {
				sessionStorage.setItem(NAME, JSON.stringify({ address: location.pathname, scroll: scrollY, ...view() }));
			} catch (error) {
				// the page begins anew
			}
			location.reload();
		};
		setTimeout(load, 1000 * report.content.watch);
	};
}
