// Curves of all tests over each other: one panel a quantity, one zoom and one cursor for all.
{
	const WIDTH = 440,
		HEIGHT = 250,
		LEFT = 50,
		RIGHT = 22,
		TOP = 10,
		BOTTOM = 34,
		COLOURS = 8,
		MANY = 6,
		MOST_TAGS = 8,
		TAG = 11,
		DECADES = 4,
		BEYOND = 0.5, // share of the range of a figure's curves that bands have above and below them: those of two tests are wide
		OUTSIDE = 0.02, // share of a logarithmic figure's lowest values that may lie outside: a start from rest is near 0
		MOST_PASSES = 4;
	const DASHES = ["none", "7 3", "2 2.5", "9 3 2 3"];
	const { content } = report;
	const state = { stage: "shear", domain: null, cursor: null, marker: {} };
	const panels = [];

	// What can be drawn: means of groups first, then tests, then a laboratory's.
	const series = [
		...content.groups.map((one) => ({ name: one.name, kind: "mean", stages: { shear: one.shear } })),
		...content.runs.map((one) => ({ name: one.name, kind: "test", stages: one.curves, label: report.label(one) })),
		...content.laboratories.map((one) => ({ name: `laboratory: ${one.name}`, kind: "laboratory", stages: { shear: one.shear } })),
	];
	const onlyMeans = content.groups.length > 0 && content.runs.length > MANY;
	series.forEach((one, k) =>
		Object.assign(one, {
			tag: String(k + 1),
			colour: `var(--line${k % COLOURS})`,
			dash: one.kind === "laboratory" ? "1 3" : DASHES[(k + Math.floor(k / COLOURS)) % DASHES.length],
			width: one.kind === "mean" ? 2.6 : 1.5,
			shown: !(onlyMeans && one.kind === "test"),
		}),
	);

	const visible = (panel) => series.filter((one) => one.shown && one.stages[state.stage]?.[panel.name]);
	// Where a curve that turns round passes x: its first values there, as text.
	const valuesAt = (data, name, x) => {
		const found = [];
		for (let k = 1; k < data.x.length; ++k) {
			const [a, b] = [data.x[k - 1], data.x[k]];
			if (a !== b && Math.min(a, b) <= x && x <= Math.max(a, b) && !(x === a && k > 1)) {
				const [low, high] = [data[name][k - 1], data[name][k]];
				found.push(low === null || high === null ? null : low + ((x - a) / (b - a)) * (high - low));
			}
		}
		return found.slice(0, MOST_PASSES).map((one) => report.number(one)).join(" / ") + (found.length > MOST_PASSES ? " / ..." : "") || "–";
	};
	const valueAt = (data, name, x) => {
		const k = d3.bisectLeft(data.x, x);
		if (k === 0 || k >= data.x.length) return data[name][report.nearest(data.x, x)];
		const share = (x - data.x[k - 1]) / (data.x[k] - data.x[k - 1] || 1),
			[a, b] = [data[name][k - 1], data[name][k]];
		return a === null || b === null ? null : a + share * (b - a);
	};

	function extent(shown, panel, [from, to]) {
		const values = [],
			ends = [];
		for (const one of shown) {
			const data = one.stages[state.stage],
				half = data[`${panel.name} half width`];
			data.x.forEach((x, k) => {
				const y = data[panel.name][k];
				if (x < from || x > to || y === null || (panel.log && y <= 0)) return;
				values.push(y);
				if (half?.[k]) ends.push(y - half[k], y + half[k]);
			});
		}
		const [low, high] = panel.log ? [d3.quantile(values.sort(d3.ascending), OUTSIDE), d3.max(values)] : d3.extent(values);
		if (low === undefined) return panel.log ? [1e-6, 1] : [0, 1];
		if (panel.log) return [Math.max(low, high * 10 ** -DECADES) / 1.3, high * 1.3];
		const edge = (high - low) * 0.06 || Math.abs(high) * 0.02 || 1,
			most = (high - low) * BEYOND;
		return [Math.max(low - most, d3.min([low, ...ends])) - edge, Math.min(high + most, d3.max([high, ...ends])) + edge];
	}

	// Moves tags apart where curves end beside each other.
	function apart(places) {
		const beside = (a, b) => Math.abs(a.x - b.x) < TAG;
		places
			.sort((a, b) => a.y - b.y)
			.forEach((place, k) => {
				for (const other of places.slice(0, k)) if (beside(place, other)) place.y = Math.max(place.y, other.y + TAG);
			});
		[...places].reverse().forEach((place, k, all) => {
			place.y = Math.min(
				place.y,
				HEIGHT - BOTTOM,
				...all
					.slice(0, k)
					.filter((other) => beside(place, other))
					.map((other) => other.y - TAG),
			);
		});
	}

	function domain() {
		const ends = series.filter((one) => one.shown && one.stages[state.stage]).map((one) => one.stages[state.stage].x);
		return [d3.min(ends, (x) => d3.min(x)) ?? 0, d3.max(ends, (x) => d3.max(x)) || 1];
	}

	function make(panel, parent) {
		const axis = () => content.axes[state.stage];
		const titled = panel.title + (panel.unit ? ` [${panel.unit}]` : "");
		const csv = () => {
			const rows = [],
				unit = panel.unit ? ` [${panel.unit}]` : "",
				{ label } = axis();
			for (const one of visible(panel)) {
				const data = one.stages[state.stage],
					half = data[`${panel.name} half width`];
				data.x.forEach((x, k) => rows.push([one.name, x, data[panel.name][k], half ? half[k] : null]));
			}
			return report.csv(["curve", `${label} [${axis().unit}]`, panel.name + unit, `half width of the 95 % interval${unit}`], rows);
		};
		const { figure } = report.figure(parent, titled, panel.name, { svg: () => report.alone(svg.node()), csv });
		const svg = d3.create("svg").attr("viewBox", `0 0 ${WIDTH} ${HEIGHT}`).attr("tabindex", 0).attr("role", "img");
		const readout = report.element("output", { class: "readout" });
		figure.append(svg.node(), readout);
		const id = `clip-${panel.name}`;
		svg.append("defs")
			.append("clipPath")
			.attr("id", id)
			.append("rect")
			.attr("x", LEFT)
			.attr("y", TOP)
			.attr("width", WIDTH - LEFT - RIGHT)
			.attr("height", HEIGHT - TOP - BOTTOM);
		const grid = svg.append("g"),
			lines = svg.append("g").attr("clip-path", `url(#${id})`),
			tags = svg.append("g");
		const xAxis = svg
				.append("g")
				.attr("class", "axis")
				.attr("transform", `translate(0,${HEIGHT - BOTTOM})`),
			yAxis = svg.append("g").attr("class", "axis").attr("transform", `translate(${LEFT},0)`);
		const label = svg
			.append("text")
			.attr("x", (LEFT + WIDTH - RIGHT) / 2)
			.attr("y", HEIGHT - 3)
			.attr("text-anchor", "middle");
		const marker = svg
			.append("line")
			.attr("class", "marker")
			.attr("data-screen", "")
			.attr("y1", TOP)
			.attr("y2", HEIGHT - BOTTOM);
		const cursor = svg
			.append("line")
			.attr("class", "cursor")
			.attr("data-screen", "")
			.attr("y1", TOP)
			.attr("y2", HEIGHT - BOTTOM);
		const x = d3.scaleLinear().range([LEFT, WIDTH - RIGHT]);
		let y;

		const brush = d3
			.brushX()
			.extent([
				[LEFT, TOP],
				[WIDTH - RIGHT, HEIGHT - BOTTOM],
			])
			.on("end", () => {
				if (!d3.event.selection || !d3.event.sourceEvent) return;
				const [from, to] = d3.event.selection.map(x.invert);
				brushed.call(brush.move, null);
				if (to - from > 1e-3 * (x.domain()[1] - x.domain()[0])) zoom([from, to]);
			});
		const brushed = svg.append("g").attr("class", "brush").call(brush);
		svg.on("pointermove", () => {
			const at = x.invert(d3.mouse(svg.node())[0]);
			if (at >= x.domain()[0] && at <= x.domain()[1]) point(at);
		});
		svg.on("pointerleave", () => point(null));
		svg.on("dblclick", () => zoom(null));
		svg.on("keydown", () => {
			const [from, to] = x.domain(),
				width = to - from,
				step = width * (d3.event.shiftKey ? 0.1 : 0.01),
				at = state.cursor ?? (from + to) / 2;
			const acts = {
				ArrowLeft: () => point(Math.max(from, at - step)),
				ArrowRight: () => point(Math.min(to, at + step)),
				"+": () => zoom([at - width / 4, at + width / 4]),
				"-": () => zoom([at - width, at + width]),
				0: () => zoom(null),
				Escape: () => zoom(null),
			};
			if (acts[d3.event.key]) {
				d3.event.preventDefault();
				acts[d3.event.key]();
			}
		});

		function draw() {
			const shown = visible(panel);
			figure.hidden = shown.length === 0;
			if (figure.hidden) return;
			x.domain(state.domain ?? domain());
			y = (panel.log ? d3.scaleLog() : d3.scaleLinear()).domain(extent(shown, panel, x.domain())).range([HEIGHT - BOTTOM, TOP]);
			xAxis.call(d3.axisBottom(x).ticks(6));
			yAxis.call(panel.log ? d3.axisLeft(y).ticks(4, ".0e") : d3.axisLeft(y).ticks(5));
			label.text(`${axis().label} [${axis().unit}]`);
			const ticks = panel.log ? y.ticks(4).filter((one) => Math.abs(Math.log10(one) % 1) < 1e-9) : y.ticks(5);
			grid.selectAll("line")
				.data(ticks)
				.join("line")
				.attr("class", "grid")
				.attr("x1", LEFT)
				.attr("x2", WIDTH - RIGHT)
				.attr("y1", y)
				.attr("y2", y);
			lines.selectAll("*").remove();
			tags.selectAll("*").remove();
			const line = d3
				.line()
				.defined((p) => p[1] !== null && (!panel.log || p[1] > 0))
				.x((p) => x(p[0]))
				.y((p) => y(p[1]));
			const places = [];
			for (const one of shown) {
				const data = one.stages[state.stage],
					half = data[`${panel.name} half width`],
					points = d3.zip(data.x, data[panel.name]);
				if (half && !panel.log) {
					const area = d3
						.area()
						.defined((_, k) => half[k] !== null)
						.x((p) => x(p[0]))
						.y0((p, k) => y(p[1] - half[k]))
						.y1((p, k) => y(p[1] + half[k]));
					lines.append("path").attr("d", area(points)).style("fill", one.colour).attr("fill-opacity", 0.2);
				}
				lines
					.append("path")
					.attr("class", "curve")
					.attr("d", line(points))
					.style("stroke", one.colour)
					.attr("stroke-width", one.width)
					.attr("stroke-dasharray", one.dash);
				const last = points.filter((p) => p[0] <= x.domain()[1] && p[1] !== null && (!panel.log || p[1] > 0)).pop();
				if (last && series.length > 1 && shown.length <= MOST_TAGS) places.push({ one, x: x(last[0]) + 4, y: y(last[1]) + 4 });
			}
			apart(places);
			for (const place of places)
				tags.append("text")
					.attr("x", place.x)
					.attr("y", place.y)
					.style("fill", place.one.colour)
					.attr("font-weight", 700)
					.text(place.one.tag);
			const said = shown.slice(0, 3).map(
				(one) =>
					`${one.name}: ${d3
						.extent(one.stages[state.stage][panel.name])
						.map((v) => report.number(v))
						.join(" to ")}`,
			);
			svg.attr("aria-label", `${titled} over ${axis().label}. ${said.join("; ")}. Arrow keys move the cursor, + and - zoom, 0 shows all.`);
			point(state.cursor);
		}

		function drawCursor() {
			if (figure.hidden) return;
			const within = (at) => at !== null && at >= x.domain()[0] && at <= x.domain()[1];
			cursor.attr("visibility", within(state.cursor) ? "visible" : "hidden");
			const at = state.marker[state.stage] ?? null;
			marker.attr("visibility", within(at) ? "visible" : "hidden");
			if (within(at)) marker.attr("x1", x(at)).attr("x2", x(at));
			if (!within(state.cursor)) {
				readout.textContent = "";
				return;
			}
			cursor.attr("x1", x(state.cursor)).attr("x2", x(state.cursor));
			const values = visible(panel)
				.slice(0, MOST_TAGS)
				.map((one) => {
					const data = one.stages[state.stage];
					return (
						(series.length > 1 ? `${one.tag}: ` : "") +
						(state.stage === "stages"
							? valuesAt(data, panel.name, state.cursor)
							: state.cursor > data.x[data.x.length - 1]
								? "–"
								: report.number(valueAt(data, panel.name, state.cursor)))
					);
				});
			readout.textContent = `at ${report.number(state.cursor, 3)} ${axis().unit}:   ${values.join("   ")} ${panel.unit}`;
		}
		return { draw, drawCursor };
	}

	function point(at) {
		state.cursor = at;
		panels.forEach((panel) => panel.drawCursor());
	}

	function zoom(to) {
		const [low, high] = domain();
		state.domain = to && [Math.max(low, to[0]), Math.min(high, to[1])];
		if (state.domain && state.domain[1] - state.domain[0] >= 0.999 * (high - low)) state.domain = null;
		redraw();
	}

	const redraw = () => panels.forEach((panel) => panel.draw());

	function sample(one) {
		const svg = d3.create("svg").attr("width", 34).attr("height", 12).attr("aria-hidden", "true");
		svg.append("line")
			.attr("x1", 1)
			.attr("x2", 33)
			.attr("y1", 6)
			.attr("y2", 6)
			.style("stroke", one.colour)
			.attr("stroke-width", one.width)
			.attr("stroke-dasharray", one.dash);
		return svg.node();
	}

	report.curves = {
		// Build all into the section; nothing without rows. before: what view() gave.
		show(section, before) {
			const stages = Object.keys(content.axes).filter((stage) => series.some((one) => one.stages[stage]));
			if (!stages.length) {
				section.append(report.element("p", {}, "No row has been written yet: there are no curves."));
				return;
			}
			state.stage = [before?.stage, "stages", "shear"].find((one) => stages.includes(one)) ?? stages[0];
			if (before && state.stage === before.stage) state.domain = before.domain;
			if (before) series.forEach((one) => (one.shown = !before.hidden.includes(one.name)));
			const { element } = report;
			if (series.length > 1) {
				const all = element(
					"button",
					{
						type: "button",
						class: "screen",
						onclick: () => {
							const on = series.some((one) => !one.shown);
							boxes.forEach((box, k) => {
								box.checked = series[k].shown = on;
							});
							redraw();
						},
					},
					"all or none",
				);
				const boxes = series.map((one) =>
					element("input", {
						type: "checkbox",
						checked: one.shown,
						onchange: (event) => {
							one.shown = event.target.checked;
							redraw();
						},
					}),
				);
				section.append(
					element(
						"fieldset",
						{ class: "legend" },
						element("legend", {}, "curves "),
						all,
						...series.map((one, k) => element("label", {}, boxes[k], sample(one), element("strong", {}, one.tag), ` ${one.name}${one.label ? `: ${one.label}` : ""}`)),
					),
				);
			}
			const pick = element(
				"select",
				{
					onchange: (event) => {
						Object.assign(state, { stage: event.target.value, domain: null, cursor: null });
						redraw();
					},
				},
				...stages.map((stage) => element("option", { value: stage, selected: stage === state.stage }, content.axes[stage].name)),
			);
			section.append(
				element(
					"div",
					{ class: "tools" },
					element("label", {}, "stage ", pick),
					element("button", { type: "button", onclick: () => zoom(null) }, "whole range"),
					element("p", {}, "Drag to zoom, double click for all. Keys in a figure: arrows move the cursor, + and - zoom, 0 shows all."),
				),
			);
			if (content.groups.length)
				section.append(element("p", {}, "Bands: 95 % interval of the mean over tests that differ in their seed alone."));
			const parent = element("div", { class: "panels" });
			section.append(parent);
			panels.push(...content.panels.map((panel) => make(panel, parent)));
			redraw();
		},
		// Mark a place in all panels: stage -> place on its axis.
		mark(places) {
			state.marker = places;
			panels.forEach((panel) => panel.drawCursor());
		},
		redraw,
		// What the reader has chosen, for a page that is loaded anew.
		view: () => ({ stage: state.stage, domain: state.domain, hidden: series.filter((one) => !one.shown).map((one) => one.name) }),
	};
}
