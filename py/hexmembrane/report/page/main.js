// Builds the page and keeps its parts at one test and one strain. What was picked stands in the address, so that a page that is loaded anew is as it was.
{
	const { content, element } = report;
	const find = (id) => document.getElementById(id);
	const PAUSE = 450;
	const kept = new URLSearchParams(location.hash.slice(1));
	const state = { run: null, strains: [], parts: [] };

	function keep(name, value) {
		kept.set(name, value);
		history.replaceState(null, "", `#${kept}`);
	}

	function setTheme(theme) {
		document.documentElement.dataset.theme = theme;
		report.curves.redraw();
	}

	function theme() {
		const dark = matchMedia("(prefers-color-scheme: dark)");
		setTheme(kept.get("theme") ?? (dark.matches ? "dark" : "light"));
		dark.addEventListener("change", () => {
			if (!kept.has("theme")) setTheme(dark.matches ? "dark" : "light");
		});
		find("theme").addEventListener("click", () => {
			const next = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
			keep("theme", next);
			setTheme(next);
		});
		let before = null;
		addEventListener("beforeprint", () => {
			before = document.documentElement.dataset.theme;
			setTheme("light");
		});
		addEventListener("afterprint", () => setTheme(before));
	}

	// The strain stays in the address once the reader has chosen it; until then a page that renews itself goes on with the test.
	async function show(index, chosen) {
		find("strain").value = index;
		const strain = state.strains[index];
		find("at").textContent = report.told(state.run, strain);
		if (chosen) keep("strain", strain);
		report.curves.mark(report.marks(state.run, strain));
		await Promise.all(state.parts.map((part) => part.show(strain)));
	}

	async function pick(run, before) {
		state.run = run;
		keep("run", run.name);
		report.verdict(verdict, run);
		report.origin(origin, run);
		state.parts.forEach((part) => part.dispose?.());
		const both = run.scene && (run.clouds || run.profile),
			left = element("div"),
			right = element("div");
		state.parts = [
			...(run.scene ? [new report.Scene(left, run, before)] : []),
			...(run.clouds ? [new report.Clouds(right, run)] : []),
			...(run.profile ? [new report.Profile(right, run)] : []),
		];
		if (!run.scene) left.append(element("p", {}, "There are no frames (output.vtkEvery) to draw grains and boundary from."));
		if (run.scene && !run.clouds) right.append(element("p", {}, "There are no clouds: fields.h5 (measure.strains) is not there or cannot be read."));
		inside.className = both ? "specimen both" : "specimen";
		inside.replaceChildren(left, right);
		const all = [run.scene, run.clouds, run.profile].flatMap((part) => part?.strains ?? []);
		find("over").textContent = run.stages ? "time" : "axial strain";
		const same = run.stages ? 1e-6 * Math.max(...all) : 1e-5;
		state.strains = all.sort((a, b) => a - b).filter((one, k) => k === 0 || one - all[k - 1] > same);
		find("slide").hidden = find("play").hidden = state.strains.length < 2;
		if (!state.strains.length) return;
		find("strain").max = state.strains.length - 1;
		const wanted = kept.has("strain") ? Number(kept.get("strain")) : state.strains[state.strains.length - 1];
		await show(report.nearest(state.strains, wanted));
	}

	function play() {
		const button = find("play");
		let timer = null;
		button.addEventListener("click", () => {
			clearInterval(timer);
			const on = button.getAttribute("aria-pressed") !== "true";
			button.setAttribute("aria-pressed", on);
			button.textContent = on ? "stop" : "play";
			if (on) timer = setInterval(() => show((Number(find("strain").value) + 1) % state.strains.length, true), PAUSE);
		});
	}

	find("about").textContent =
		`${content.runs.length > 1 ? `${content.runs.length} tests` : content.runs[0].state}; made ${content.date} by hexmembrane ${content.version}${content.watch ? `; renews itself every ${content.watch} s` : ""}`;
	theme();
	report.problems();
	report.overview(find("verdict"));
	const before = report.before();
	report.curves.show(find("curves"), before?.curves);
	const [verdict, inside, origin] = ["verdict", "inside", "origin"].map((id) => {
		const made = element("div");
		find(id).append(made);
		return made;
	});
	report.differences(find("origin"));
	find("pick").hidden = content.runs.length < 2;
	find("run").append(
		...content.runs.map((run, k) => element("option", { value: k }, report.label(run) ? `${run.name}: ${report.label(run)}` : run.name)),
	);
	find("run").addEventListener("change", (event) => pick(content.runs[event.target.value]));
	find("strain").addEventListener("input", (event) => show(Number(event.target.value), true));
	play();
	const first = Math.max(
		0,
		content.runs.findIndex((run) => run.name === kept.get("run")),
	);
	find("run").value = first;
	report.state = state;
	report.ready = pick(content.runs[first], before?.scene);
	if (content.watch) report.renew(() => ({ curves: report.curves.view(), scene: state.parts[0]?.view?.() ?? null }));
	if (before) report.ready.then(() => scrollTo(0, before.scroll));
}
