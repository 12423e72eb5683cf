// Colour scales and their bars.
{
	const MAPS = {
		viridis: d3.interpolateViridis,
		cividis: d3.interpolateCividis,
		inferno: d3.interpolateInferno,
		magma: d3.interpolateMagma,
		plasma: d3.interpolatePlasma,
		RdBu_r: (t) => d3.interpolateRdBu(1 - t),
	};
	const GREY = [150, 150, 150];
	const STEPS = 256;

	const table = (name) =>
		Array.from({ length: STEPS }, (_, k) => {
			const c = d3.rgb(MAPS[name](k / (STEPS - 1)));
			return [c.r, c.g, c.b];
		});
	const tables = {};

	// value -> [r, g, b] of 0 to 255; what is no number is grey.
	report.scale = (name, [low, high]) => {
		const colours = (tables[name] ??= table(name));
		const share = (value) => (high > low ? (value - low) / (high - low) : 0.5);
		return (value) => (Number.isNaN(value) ? GREY : colours[Math.max(0, Math.min(STEPS - 1, Math.round((STEPS - 1) * share(value))))]);
	};

	let bars = 0;
	// A horizontal bar with its ends and its label, into an SVG selection at (x, y).
	report.bar = (parent, x, y, width, name, [low, high], label) => {
		const id = `bar${++bars}`,
			group = parent.append("g").attr("transform", `translate(${x},${y})`);
		const gradient = group.append("defs").append("linearGradient").attr("id", id);
		for (let k = 0; k <= 16; ++k)
			gradient
				.append("stop")
				.attr("offset", k / 16)
				.attr("stop-color", d3.rgb(MAPS[name](k / 16)).toString());
		group.append("rect").attr("width", width).attr("height", 9).attr("fill", `url(#${id})`).attr("class", "bar");
		const end = (value) => report.number(Math.abs(value) < 1e-4 * (high - low) ? 0 : value, 3);
		group.append("text").attr("y", 21).text(end(low));
		group.append("text").attr("x", width).attr("y", 21).attr("text-anchor", "end").text(end(high));
		if (label) group.append("text").attr("y", -5).text(label);
		return group;
	};
}
