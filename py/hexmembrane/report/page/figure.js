// A figure with its title and buttons that save it as SVG and its data as CSV.
{
	const STYLES = ["fill", "stroke", "stroke-width", "stroke-dasharray", "fill-opacity", "font-size", "font-family", "font-weight", "text-anchor"];

	report.save = (name, type, text) => {
		const link = report.element("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
		link.click();
		setTimeout(() => URL.revokeObjectURL(link.href), 1000);
	};

	// An SVG that stands alone: what style sheets say is written into it.
	report.alone = (svg) => {
		const copy = svg.cloneNode(true),
			box = svg.viewBox.baseVal;
		const pairs = [[svg, copy], ...Array.from(svg.querySelectorAll("*"), (one, k) => [one, copy.querySelectorAll("*")[k]])];
		for (const [one, other] of pairs) {
			const computed = getComputedStyle(one);
			for (const name of STYLES)
				if (!(name === "fill" && one.getAttribute("fill")?.startsWith("url"))) other.setAttribute(name, computed.getPropertyValue(name));
			other.removeAttribute("class");
		}
		copy.querySelectorAll(".brush, [data-screen]").forEach((one) => one.remove());
		copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
		copy.setAttribute("width", box.width);
		copy.setAttribute("height", box.height);
		const back = document.createElementNS("http://www.w3.org/2000/svg", "rect");
		for (const [name, value] of [
			["x", box.x],
			["y", box.y],
			["width", box.width],
			["height", box.height],
		])
			back.setAttribute(name, value);
		back.setAttribute("fill", getComputedStyle(svg.closest("section")).backgroundColor);
		copy.prepend(back);
		return new XMLSerializer().serializeToString(copy);
	};

	const cell = (value) =>
		typeof value === "number" || value === null || value === undefined
			? Number.isFinite(value)
				? String(value)
				: "nan"
			: `"${String(value).replaceAll('"', '""')}"`;
	report.csv = (headers, rows) => [headers, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";

	// name: of the files; svg, csv: functions that give their texts.
	report.figure = (parent, title, name, { svg, csv }) => {
		const caption = report.element("span", {}, title),
			file = name.replace(/[^A-Za-z0-9_-]+/g, "-");
		const buttons = [
			report.element(
				"button",
				{
					type: "button",
					title: "save this figure as SVG",
					"aria-label": `save as SVG: ${title}`,
					onclick: () => report.save(`${file}.svg`, "image/svg+xml", svg()),
				},
				"SVG",
			),
			report.element(
				"button",
				{
					type: "button",
					title: "save its data as CSV",
					"aria-label": `save as CSV: ${title}`,
					onclick: () => report.save(`${file}.csv`, "text/csv", csv()),
				},
				"CSV",
			),
		];
		const figure = report.element("figure", {}, report.element("figcaption", {}, caption, ...buttons));
		parent.append(figure);
		return { figure, caption };
	};
}
